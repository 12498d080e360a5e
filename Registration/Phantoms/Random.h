#pragma once

#include <cstdint>
#include <random>

namespace crease {

/// Random numbers that are the same with every compiler and library: the engine's sequence is fixed
/// by the standard, and the distributions are our own (those of the standard library are not
/// fixed).
class Random {
 public:
  /// @param stream  separates the uses of one seed, so that one draw more here moves nothing there.
  Random(std::uint64_t seed, std::uint64_t stream);

  /// Uniform in [0, 1), 53 bits.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }
  /// Normal with mean 0 and deviation 1 (Box and Muller 1958).
  double normal();

 private:
  std::mt19937_64 engine_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace crease

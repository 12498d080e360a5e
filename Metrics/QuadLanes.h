#pragma once

#include <cstring>

/// Four floats at a time, for kernel files alone: each is compiled for several instruction sets, so that
/// nothing here may be shared between them.
namespace crease::CREASE_ISA {
namespace {

using Quad = float __attribute__((vector_size(16)));
using QuadIndex = int __attribute__((vector_size(16)));

inline Quad load(const float* p) {
  Quad v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

inline void store(float* p, Quad v) { std::memcpy(p, &v, sizeof v); }

/// The sums of the four lanes of a, b, c and d.
inline Quad sums_of_lanes(Quad a, Quad b, Quad c, Quad d) {
  const Quad ab = __builtin_shuffle(a, b, QuadIndex{0, 4, 1, 5}) +
                  __builtin_shuffle(a, b, QuadIndex{2, 6, 3, 7});
  const Quad cd = __builtin_shuffle(c, d, QuadIndex{0, 4, 1, 5}) +
                  __builtin_shuffle(c, d, QuadIndex{2, 6, 3, 7});
  return __builtin_shuffle(ab, cd, QuadIndex{0, 1, 4, 5}) +
         __builtin_shuffle(ab, cd, QuadIndex{2, 3, 6, 7});
}

}  // namespace
}  // namespace crease::CREASE_ISA

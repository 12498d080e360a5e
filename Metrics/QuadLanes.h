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

using Double4 = double __attribute__((vector_size(32)));

inline Double4 doubles(Quad v) { return __builtin_convertvector(v, Double4); }
inline Quad singles(Double4 v) { return __builtin_convertvector(v, Quad); }

inline void store(float* p, Quad v) { std::memcpy(p, &v, sizeof v); }

/// Lane n of entry m becomes lane m of entry n.
inline void transpose(Quad (&v)[4]) {
  const Quad a = __builtin_shuffle(v[0], v[1], QuadIndex{0, 4, 1, 5});
  const Quad b = __builtin_shuffle(v[0], v[1], QuadIndex{2, 6, 3, 7});
  const Quad c = __builtin_shuffle(v[2], v[3], QuadIndex{0, 4, 1, 5});
  const Quad d = __builtin_shuffle(v[2], v[3], QuadIndex{2, 6, 3, 7});
  v[0] = __builtin_shuffle(a, c, QuadIndex{0, 1, 4, 5});
  v[1] = __builtin_shuffle(a, c, QuadIndex{2, 3, 6, 7});
  v[2] = __builtin_shuffle(b, d, QuadIndex{0, 1, 4, 5});
  v[3] = __builtin_shuffle(b, d, QuadIndex{2, 3, 6, 7});
}

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

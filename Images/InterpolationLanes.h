#pragma once

// Vectors of samples for the interpolation kernels: eight lanes with AVX2, four without. A register is
// made of quads (4 floats); quad q serves the samples 4 q .. 4 q + 3.

#include <cstring>

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace crease::CREASE_ISA {

#if defined(__AVX2__)
constexpr int kLanes = 8;
#else
constexpr int kLanes = 4;
#endif

using Floats = float __attribute__((vector_size(4 * kLanes)));
using Ints = int __attribute__((vector_size(4 * kLanes)));
using Quad = float __attribute__((vector_size(16)));
using Pair = float __attribute__((vector_size(8)));

inline Floats load(const float* p) {
  Floats v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store(float* p, Floats v) { std::memcpy(p, &v, sizeof v); }

inline Quad load_quad(const float* p) {
  Quad v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
/// (p[0], p[1], q[0], q[1])
inline Quad load_pairs(const float* p, const float* q) {
  Pair a, b;
  std::memcpy(&a, p, sizeof a);
  std::memcpy(&b, q, sizeof b);
  return __builtin_shufflevector(a, b, 0, 1, 2, 3);
}

inline Floats all(float x) { return x - Floats{}; }
/// The bits of v where the mask is -1, zero where it is 0.
inline Floats where(Ints mask, Floats v) { return (Floats)(mask & (Ints)v); }

#if defined(__AVX2__)

inline Floats join(Quad low, Quad high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
/// Two quads from memory; the second is loaded straight into its half.
inline Floats load_quads(const float* low, const float* high) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(low)), _mm_loadu_ps(high), 1);
}
inline Floats floor(Floats v) { return _mm256_floor_ps(v); }
/// Copies lane G of each quad to the whole quad.
template <int G>
Floats spread(Floats v) {
  return __builtin_shufflevector(v, v, G, G, G, G, 4 + G, 4 + G, 4 + G, 4 + G);
}
/// Transposes the 4 x 4 numbers of each quad: v[g] holds what belongs to sample g before, component g
/// of all samples afterwards.
inline void transpose(Floats (&v)[4]) {
  const Floats a = __builtin_shufflevector(v[0], v[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const Floats b = __builtin_shufflevector(v[0], v[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const Floats c = __builtin_shufflevector(v[2], v[3], 0, 8, 1, 9, 4, 12, 5, 13);
  const Floats d = __builtin_shufflevector(v[2], v[3], 2, 10, 3, 11, 6, 14, 7, 15);
  v[0] = __builtin_shufflevector(a, c, 0, 1, 8, 9, 4, 5, 12, 13);
  v[1] = __builtin_shufflevector(a, c, 2, 3, 10, 11, 6, 7, 14, 15);
  v[2] = __builtin_shufflevector(b, d, 0, 1, 8, 9, 4, 5, 12, 13);
  v[3] = __builtin_shufflevector(b, d, 2, 3, 10, 11, 6, 7, 14, 15);
}

#else

inline Floats floor(Floats v) {
  const Floats whole = __builtin_convertvector(__builtin_convertvector(v, Ints), Floats);
  return whole - where(whole > v, all(1.0f));
}
template <int G>
Floats spread(Floats v) {
  return __builtin_shufflevector(v, v, G, G, G, G);
}
inline void transpose(Floats (&v)[4]) {
  const Floats a = __builtin_shufflevector(v[0], v[1], 0, 4, 1, 5);
  const Floats b = __builtin_shufflevector(v[0], v[1], 2, 6, 3, 7);
  const Floats c = __builtin_shufflevector(v[2], v[3], 0, 4, 1, 5);
  const Floats d = __builtin_shufflevector(v[2], v[3], 2, 6, 3, 7);
  v[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  v[1] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  v[2] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  v[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

#endif

}  // namespace crease::CREASE_ISA

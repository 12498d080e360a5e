#include "Images/PrefilterKernel.h"

#include <cstring>

namespace crease::CREASE_ISA {
namespace {

constexpr float kPole = -0.2679491924311227f;  // sqrt(3) - 2
constexpr float kGain = 6;                     // (1 - pole) (1 - 1/pole)

using Quad = float __attribute__((vector_size(16)));

Quad load(const float* p) {
  Quad v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
void store(float* p, Quad v) { std::memcpy(p, &v, sizeof v); }

inline void transpose_4x4(const float* from, long from_stride, float* to, long to_stride) {
  const Quad r0 = load(from), r1 = load(from + from_stride), r2 = load(from + 2 * from_stride),
             r3 = load(from + 3 * from_stride);
  const Quad a = __builtin_shufflevector(r0, r1, 0, 4, 1, 5);
  const Quad b = __builtin_shufflevector(r0, r1, 2, 6, 3, 7);
  const Quad c = __builtin_shufflevector(r2, r3, 0, 4, 1, 5);
  const Quad d = __builtin_shufflevector(r2, r3, 2, 6, 3, 7);
  store(to, __builtin_shufflevector(a, c, 0, 1, 4, 5));
  store(to + to_stride, __builtin_shufflevector(a, c, 2, 3, 6, 7));
  store(to + 2 * to_stride, __builtin_shufflevector(b, d, 0, 1, 4, 5));
  store(to + 3 * to_stride, __builtin_shufflevector(b, d, 2, 3, 6, 7));
}

/// First element of the causal pass of 16 lines or fewer.
void start_lines(float* data, int width, long stride, const float* start, int num_start) {
  float first[16] = {};
  for (int k = 0; k < num_start; ++k) {
    for (int x = 0; x < width; ++x) first[x] += start[k] * data[k * stride + x];
  }
  for (int x = 0; x < width; ++x) data[x] = kGain * first[x];
}

}  // namespace

void prefilter_lines(float* data, int width, long stride, int length, const float* start,
                     int num_start) {
  for (int x = 0; x < width; x += 16) {
    start_lines(data + x, width - x < 16 ? width - x : 16, stride, start, num_start);
  }
  for (int k = 1; k < length; ++k) {
    float* __restrict line = data + k * stride;
    const float* __restrict before = line - stride;
    for (int x = 0; x < width; ++x) line[x] = kGain * line[x] + kPole * before[x];
  }
  // c(n-1) = pole / (pole^2 - 1) (c+(n-1) + pole c+(n-2)), the mirror condition at the far end.
  constexpr float kEnd = kPole / (kPole * kPole - 1);
  float* last = data + (length - 1) * stride;
  for (int x = 0; x < width; ++x) last[x] = kEnd * (last[x] + kPole * last[x - stride]);
  for (int k = length - 2; k >= 0; --k) {
    float* __restrict line = data + k * stride;
    const float* __restrict after = line + stride;
    for (int x = 0; x < width; ++x) line[x] = kPole * (after[x] - line[x]);
  }
}

void transpose(const float* from, long from_stride, float* to, long to_stride, int rows,
               int columns) {
  int r = 0;
  for (; r + 4 <= rows; r += 4) {
    int c = 0;
    for (; c + 4 <= columns; c += 4) {
      transpose_4x4(from + r * from_stride + c, from_stride, to + c * to_stride + r, to_stride);
    }
    for (; c < columns; ++c) {
      for (int k = r; k < r + 4; ++k) to[c * to_stride + k] = from[k * from_stride + c];
    }
  }
  for (; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) to[c * to_stride + r] = from[r * from_stride + c];
  }
}

}  // namespace crease::CREASE_ISA

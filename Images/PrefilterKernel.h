#pragma once

namespace crease {

/// The recursive filter along many lines side by side: element k of line x stands at
/// data[k * stride + x], 0 <= x < width, 0 <= k < length. In place.
/// @param start  weights with which the first `num_start` elements give the filter's start value.
using PrefilterLinesKernel = void(float* data, int width, long stride, int length,
                                  const float* start, int num_start);

/// to[c * to_stride + r] = from[r * from_stride + c] for r < rows, c < columns.
using TransposeKernel = void(const float* from, long from_stride, float* to, long to_stride,
                             int rows, int columns);

namespace baseline {
PrefilterLinesKernel prefilter_lines;
TransposeKernel transpose;
}  // namespace baseline
namespace avx2 {
PrefilterLinesKernel prefilter_lines;
TransposeKernel transpose;
}  // namespace avx2

}  // namespace crease

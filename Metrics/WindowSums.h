#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

namespace crease {

/// Sums over windows of 2 radius + 1 samples a side, clipped at the border, of four numbers per sample at
/// once. Numbers of one sample lie side by side, rows one behind the other, window_row_size() apart.
constexpr int kWindowNumbers = 4;

/// Entries of a row, which has room for whole fours of samples.
inline std::size_t window_row_size(int width) {
  return static_cast<std::size_t>(kWindowNumbers) * ((width + 3) / 4 * 4);
}

/// Along one row of `count` samples. `sums` is another row.
void sum_along_row(const float* values, int count, int radius, float* sums);

/// What is done with the sums of a row; called once for each, from several threads.
using UseWindowRow = std::function<void(std::int64_t row, const float* sums)>;

/// Across rows, and in space across planes, of what has been summed along rows. The cost does not depend on
/// the radius.
/// @param size     samples along a row, rows of a plane, planes.
/// @param rows     of all samples. @param scratch  of the same size.
/// @param use      may write to what window_target() is.
void sum_across_rows(std::span<float> rows, std::span<float> scratch,
                     const std::array<int, 3>& size, int radius, const UseWindowRow& use);

/// Which of the two is no longer needed while rows are used.
inline std::span<float> window_target(std::span<float> rows, std::span<float> scratch,
                                      const std::array<int, 3>& size) {
  return size[2] > 1 ? rows : scratch;
}

}  // namespace crease

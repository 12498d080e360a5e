#include "Metrics/WindowSums.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "Core/Parallel.h"

namespace crease {
namespace {

constexpr int kColumns = 64;  // that are summed together across rows

/// Sums along one row.
void sum_row(float* row, int count, int radius, std::vector<float>& copy) {
  copy.assign(row, row + count);
  double sum = 0;
  for (int i = 0; i < std::min(radius, count); ++i) sum += copy[i];
  for (int i = 0; i < count; ++i) {
    if (i + radius < count) sum += copy[i + radius];
    if (i - radius > 0) sum -= copy[i - radius - 1];
    row[i] = static_cast<float>(sum);
  }
}

/// Sums across `count` rows that are `step` entries apart, for `width` columns.
void sum_across(float* first, std::size_t step, int count, int width, int radius,
                std::vector<float>& copy) {
  copy.resize(static_cast<std::size_t>(count) * width);
  for (int j = 0; j < count; ++j) {
    std::copy_n(first + j * step, width, copy.begin() + static_cast<std::ptrdiff_t>(j) * width);
  }
  double sums[kColumns] = {};
  const auto add = [&](int j, double sign) {
    const float* row = &copy[static_cast<std::size_t>(j) * width];
    for (int i = 0; i < width; ++i) sums[i] += sign * row[i];
  };
  for (int j = 0; j < std::min(radius, count); ++j) add(j, 1);
  for (int j = 0; j < count; ++j) {
    if (j + radius < count) add(j + radius, 1);
    if (j - radius > 0) add(j - radius - 1, -1);
    for (int i = 0; i < width; ++i) first[j * step + i] = static_cast<float>(sums[i]);
  }
}

}  // namespace

void sum_windows(std::span<float> values, const std::array<int, 3>& size, std::size_t stride,
                 int radius) {
  const std::int64_t rows = static_cast<std::int64_t>(size[1]) * size[2];
  parallel_for((rows + 15) / 16, [&](std::int64_t part) {
    std::vector<float> copy;
    for (std::int64_t r = 16 * part; r < std::min(rows, 16 * part + 16); ++r) {
      sum_row(&values[static_cast<std::size_t>(r) * stride], size[0], radius, copy);
    }
  });
  const int parts = (size[0] + kColumns - 1) / kColumns;
  for (int axis : {1, 2}) {
    if (size[axis] == 1) continue;
    const std::size_t step = axis == 1 ? stride : stride * size[1];
    const std::size_t other_step = axis == 1 ? stride * size[1] : stride;
    const int others = axis == 1 ? size[2] : size[1];
    parallel_for(static_cast<std::int64_t>(parts) * others, [&](std::int64_t task) {
      std::vector<float> copy;
      const int column = static_cast<int>(task % parts) * kColumns;
      float* first = &values[static_cast<std::size_t>(task / parts) * other_step + column];
      sum_across(first, step, size[axis], std::min(kColumns, size[0] - column), radius, copy);
    });
  }
}

}  // namespace crease

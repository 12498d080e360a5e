#include "Metrics/WindowSums.h"

#include <algorithm>
#include <vector>

#include "Core/Cpu.h"
#include "Core/Parallel.h"
#include "Metrics/WindowSumsKernel.h"

namespace crease {
namespace {

constexpr int kBand = 64;  // rows that are summed one after another

/// Rows first, first + step, ... of which each has `entries` numbers.
struct Line {
  const float* first;
  std::size_t step;
  int count;
  int entries;
};

/// Sums of rows begin .. end-1 of a line over 2 radius + 1 of its rows.
void sum_band(const Line& line, int begin, int end, int radius,
              const std::function<void(int, const float*)>& use) {
  const auto kernel = cpu_has_avx2() ? avx2::advance_sums : baseline::advance_sums;
  const auto entries = static_cast<std::size_t>(line.entries);
  const std::vector<float> nothing(entries, 0.0f);
  std::vector<double> sums(entries, 0.0);
  std::vector<float> out(entries);
  const auto row = [&](int j) {
    const bool there = j >= 0 && j < line.count;
    return there ? line.first + static_cast<std::size_t>(j) * line.step : nothing.data();
  };
  for (int j = begin - radius; j < begin + radius; ++j) {
    kernel(sums.data(), row(j), nothing.data(), line.entries, out.data());
  }
  for (int j = begin; j < end; ++j) {
    const float* leave = j > begin ? row(j - radius - 1) : nothing.data();
    kernel(sums.data(), row(j + radius), leave, line.entries, out.data());
    use(j, out.data());
  }
}

}  // namespace

void sum_along_row(const float* values, int count, int radius, float* sums) {
  const auto kernel = cpu_has_avx2() ? avx2::sum_along_row : baseline::sum_along_row;
  kernel(values, count, radius, sums);
}

void sum_across_rows(std::span<float> rows, std::span<float> scratch,
                     const std::array<int, 3>& size, int radius, const UseWindowRow& use) {
  const std::size_t row_size = window_row_size(size[0]);
  const std::int64_t in_plane = size[1], planes = size[2];
  const auto along = [&](const float* from, int axis, const UseWindowRow& take) {
    const std::int64_t step = axis == 1 ? 1 : in_plane, other_step = axis == 1 ? in_plane : 1;
    const std::int64_t bands = (size[axis] + kBand - 1) / kBand;
    parallel_for(bands * (axis == 1 ? planes : in_plane), [&](std::int64_t task) {
      const std::int64_t first = task / bands * other_step;
      const Line line{from + static_cast<std::size_t>(first) * row_size,
                      static_cast<std::size_t>(step) * row_size, size[axis],
                      static_cast<int>(row_size)};
      const int begin = static_cast<int>(task % bands) * kBand;
      sum_band(line, begin, std::min(size[axis], begin + kBand), radius,
               [&](int j, const float* sums) { take(first + j * step, sums); });
    });
  };
  if (planes == 1) {
    along(rows.data(), 1, use);
    return;
  }
  along(rows.data(), 1, [&](std::int64_t r, const float* sums) {
    std::copy_n(sums, row_size, scratch.begin() + r * static_cast<std::int64_t>(row_size));
  });
  along(scratch.data(), 2, use);
}

}  // namespace crease

#include "Images/BSplinePrefilter.h"

#include <algorithm>
#include <cmath>

#include "Core/Cpu.h"
#include "Core/Parallel.h"
#include "Images/PrefilterKernel.h"

namespace crease {
namespace {

constexpr int kTileRows = 16;    // rows that are transposed and filtered together
constexpr int kStripWidth = 64;  // columns that are filtered together: four cache lines

/// Weights of the first elements in the causal start value sum_k pole^|k| f(k) over the mirrored line:
/// exact for short lines; what long lines leave out is below 1e-10.
std::vector<float> start_weights(int length) {
  const double pole = std::sqrt(3.0) - 2;
  constexpr int kTerms = 18;
  std::vector<float> weights;
  for (int k = 0; k < std::min(length, kTerms); ++k) {
    double w = std::pow(pole, k);
    if (length <= kTerms) {
      if (k > 0 && k < length - 1) w += std::pow(pole, 2 * length - 2 - k);
      w /= 1 - std::pow(pole, 2 * length - 2);
    }
    weights.push_back(static_cast<float>(w));
  }
  return weights;
}

void filter_lines(float* data, int width, std::int64_t stride, int length,
                  const std::vector<float>& start) {
  const auto kernel = cpu_has_avx2() ? avx2::prefilter_lines : baseline::prefilter_lines;
  kernel(data, width, stride, length, start.data(), static_cast<int>(start.size()));
}

/// Copies the image and filters it along the first axis: tiles of rows are turned into columns.
template <int Dim>
void filter_rows(const Image<float, Dim>& image, PaddedPixels<Dim>& out) {
  const int width = image.size()[0];
  const std::int64_t rows = image.raster().num_rows();
  const auto start = start_weights(width);
  const auto transpose = cpu_has_avx2() ? avx2::transpose : baseline::transpose;
  parallel_for((rows + kTileRows - 1) / kTileRows, [&](std::int64_t tile) {
    const std::int64_t first = tile * kTileRows;
    const int count = static_cast<int>(std::min<std::int64_t>(kTileRows, rows - first));
    static thread_local std::vector<float> columns;
    columns.resize(static_cast<std::size_t>(width) * kTileRows);
    transpose(image.row(first).data(), width, columns.data(), kTileRows, count, width);
    if (width > 1) filter_lines(columns.data(), kTileRows, kTileRows, width, start);
    // The rows of a tile may lie in two slices.
    for (int done = 0; done < count;) {
      const std::int64_t r = first + done;
      const int left = image.size()[1] - static_cast<int>(r % image.size()[1]);
      const int run = std::min(count - done, left);
      transpose(columns.data() + done, kTileRows, out.data() + out.row_offset(r), out.stride()[1],
                width, run);
      done += run;
    }
  });
}

/// Filters in place along the second or third axis.
template <int Dim>
void filter_columns(PaddedPixels<Dim>& pixels, int axis) {
  const int length = pixels.size()[axis];
  if (length == 1) return;
  const auto start = start_weights(length);
  const int width = pixels.size()[0];
  const std::int64_t strips = (width + kStripWidth - 1) / kStripWidth;
  const int other = Dim == 3 ? 3 - axis : 0;  // the axis that the columns are repeated along
  const std::int64_t repeats = Dim == 3 ? pixels.size()[other] : 1;
  parallel_for(repeats * strips, [&](std::int64_t item) {
    const int x = static_cast<int>(item % strips) * kStripWidth;
    float* data = pixels.data() + x;
    if (Dim == 3) data += (item / strips) * pixels.stride()[other];
    filter_lines(data, std::min(kStripWidth, width - x), pixels.stride()[axis], length, start);
  });
}

}  // namespace

template <int Dim>
PaddedPixels<Dim> cubic_bspline_coefficients(const Image<float, Dim>& image) {
  check_interpolable(image);
  PaddedPixels<Dim> coefficients(image.size());
  filter_rows(image, coefficients);
  for (int a = 1; a < Dim; ++a) filter_columns(coefficients, a);
  coefficients.pad();
  return coefficients;
}

template PaddedPixels<2> cubic_bspline_coefficients<2>(const Image<float, 2>&);
template PaddedPixels<3> cubic_bspline_coefficients<3>(const Image<float, 3>&);

}  // namespace crease

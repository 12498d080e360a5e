#include "Images/SeparableFilter.h"

#include <algorithm>

#include "Core/Cpu.h"
#include "Core/Parallel.h"
#include "Images/WeightedSumKernel.h"

namespace crease {
namespace {

constexpr std::int64_t kTileRows = 16;

void weighted_sum(const std::vector<const float*>& lines, std::span<const float> weights, int width,
                  float* out) {
  const auto kernel = cpu_has_avx2() ? avx2::weighted_sum : baseline::weighted_sum;
  kernel(lines.data(), weights.data(), static_cast<int>(weights.size()), width, out);
}

/// Along the first axis: the row is split by index modulo `step`, so that the taps of neighbouring
/// results are neighbours.
class RowFilter {
 public:
  RowFilter(std::span<const float> weights, int before, int step)
      : weights_(weights), before_(before), step_(step) {}

  void apply(std::span<const float> in, std::span<float> out) {
    const int taps = static_cast<int>(weights_.size());
    const int length = static_cast<int>(out.size()) + (taps + step_ - 1) / step_;
    const int last = static_cast<int>(in.size()) - 1;
    phases_.resize(static_cast<std::size_t>(length) * step_);
    for (int p = 0; p < step_; ++p) {
      float* phase = phases_.data() + static_cast<std::size_t>(p) * length;
      for (int m = 0; m < length; ++m) {
        phase[m] = in[static_cast<std::size_t>(std::clamp(step_ * m + p - before_, 0, last))];
      }
    }
    lines_.resize(weights_.size());
    for (int t = 0; t < taps; ++t) {
      lines_[static_cast<std::size_t>(t)] =
          phases_.data() + static_cast<std::size_t>(t % step_) * length + t / step_;
    }
    weighted_sum(lines_, weights_, static_cast<int>(out.size()), out.data());
  }

 private:
  std::span<const float> weights_;
  int before_, step_;
  std::vector<float> phases_;
  std::vector<const float*> lines_;
};

}  // namespace

template <int Dim>
Image<float, Dim> filter_axis(const Image<float, Dim>& image, int axis,
                              std::span<const float> weights, int before, int step,
                              const Raster<Dim>& result) {
  Image<float, Dim> out(result);
  const std::int64_t rows = result.num_rows();
  // Rows of the image from one index to the next along the axis, and of the result.
  const std::int64_t in_stride = axis == 2 ? image.size()[1] : 1;
  const int out_length = result.size[axis];
  const int last = image.size()[axis] - 1;
  parallel_for((rows + kTileRows - 1) / kTileRows, [&](std::int64_t tile) {
    RowFilter row_filter(weights, before, step);
    std::vector<const float*> lines(weights.size());
    for (std::int64_t r = tile * kTileRows; r < std::min(rows, (tile + 1) * kTileRows); ++r) {
      if (axis == 0) {
        row_filter.apply(image.row(r), out.row(r));
        continue;
      }
      const std::int64_t i = axis == 1 ? r % out_length : r / in_stride;
      const std::int64_t first = axis == 1 ? r / out_length * (last + 1) : r % in_stride;
      for (std::size_t t = 0; t < weights.size(); ++t) {
        const auto k =
            std::clamp<std::int64_t>(step * i + static_cast<std::int64_t>(t) - before, 0, last);
        lines[t] = image.row(first + k * in_stride).data();
      }
      weighted_sum(lines, weights, result.size[0], out.row(r).data());
    }
  });
  return out;
}

template Image<float, 2> filter_axis<2>(const Image<float, 2>&, int, std::span<const float>, int,
                                        int, const Raster<2>&);
template Image<float, 3> filter_axis<3>(const Image<float, 3>&, int, std::span<const float>, int,
                                        int, const Raster<3>&);

}  // namespace crease

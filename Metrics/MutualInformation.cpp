#include "Metrics/MutualInformation.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "Core/Cpu.h"
#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Metrics/InformationKernel.h"

namespace crease {
namespace {

/// Counts of a tile's samples.
template <int Dim>
struct HistogramSums final : Metric<Dim>::Sums {
  explicit HistogramSums(int bins)
      : num_bins(bins), counts(static_cast<std::size_t>(kHistogramCopies) * bins * bins, 0) {}

  /// Makes room for the further samples of a row.
  void reserve(int samples) {
    samples = (samples + kHistogramCopies - 1) / kHistogramCopies * kHistogramCopies;
    if (num_samples + samples > kHistogramCapacity) {
      if (!earlier) earlier.emplace(num_bins);
      add_counts_to(*earlier);
      std::fill(counts.begin(), counts.end(), 0);
      num_samples = 0;
    }
    num_samples += samples;
  }
  void add_to(JointHistogram& total) const {
    if (earlier) total += *earlier;
    add_counts_to(total);
  }

  int num_bins, num_samples = 0;  // those in `counts`
  std::vector<std::int32_t> counts;
  std::optional<JointHistogram> earlier;

 private:
  void add_counts_to(JointHistogram& total) const {
    const std::size_t size = counts.size() / kHistogramCopies;
    for (int copy = 0; copy < kHistogramCopies; ++copy) {
      total += std::span(counts).subspan(copy * size, size);
    }
  }
};

BinScale single(const IntensityBins& bins) {
  return {static_cast<float>(bins.lower()), static_cast<float>(bins.per_intensity()),
          static_cast<float>(bins.last())};
}

/// The bins of a fixed intensity and its shares in them.
struct FixedShares {
  FixedShares(double position, FixedWindow window) {
    if (window == FixedWindow::kBox) {
      first = static_cast<int>(position + 0.5);  // NOLINT(bugprone-incorrect-roundings): above 0
      count = 1;
      value[0] = 1;
    } else {
      const CubicWindow cubic(position);
      first = cubic.first;
      count = 4;
      std::copy(cubic.value, cubic.value + 4, value);
    }
  }
  int first, count;
  double value[4];
};

/// sum_l shares[l] table[l] over four bins.
template <typename Table>
double taps(const double (&shares)[4], const Table* table) {
  return shares[0] * table[0] + shares[1] * table[1] + shares[2] * table[2] + shares[3] * table[3];
}

void add_sample(JointHistogram& histogram, const FixedShares& fixed, const CubicWindow& moving,
                double weight) {
  for (int n = 0; n < fixed.count; ++n) {
    double* row = histogram.row(fixed.first + n) + moving.first;
    const double share = weight * fixed.value[n];
    for (int l = 0; l < 4; ++l) row[l] += share * moving.value[l];
  }
}

/// The bins of n samples.
MutualInformationOptions with_enough_samples(MutualInformationOptions options, double n) {
  constexpr int kFewest = 8, kMost = 256;
  if (options.bins < kFewest || options.bins > kMost) {
    throw InvalidInput(
        message("mutual information: ", options.bins, " bins; give ", kFewest, " to ", kMost));
  }
  options.bins = std::clamp(static_cast<int>(4 + std::sqrt(n) / 2), kFewest, options.bins);
  return options;
}

template <int Dim>
IntensityBins moving_bins(const MetricInput<Dim>& input, int bins) {
  const IntensityRange range =
      input.moving_range ? *input.moving_range : input.moving->coefficient_range();
  constexpr double kRounding = 1e-5;  // of the prefilter, in single precision
  if (range.width() <= kRounding * std::max(std::abs(range.lower), std::abs(range.upper))) {
    throw InvalidInput(message("mutual information: the moving image is constant (", range.lower,
                               ") where it counts; there is nothing to compare"));
  }
  return {range, bins};
}

}  // namespace

template <int Dim>
MutualInformation<Dim>::MutualInformation(MetricInput<Dim> input,
                                          const MutualInformationOptions& options)
    : IntensityMetric<Dim>(std::move(input)),
      options_(with_enough_samples(options, this->fixed_statistics().weight)),
      fixed_bins_({this->fixed_statistics().lower - this->fixed_statistics().mean,
                   this->fixed_statistics().upper - this->fixed_statistics().mean},
                  options_.bins),
      moving_bins_(moving_bins(this->input(), options_.bins)) {
  unit_ = kNoisePower * this->fixed_statistics().weight * this->fixed_raster().sample_volume();
  // Near a match the joint entropy is about the fixed image's: normalised information changes by a change
  // of mutual information over that.
  if (options_.kind == InformationKind::kNormalized) unit_ *= fixed_entropy();
  counts_per_weight_ = kCountsPerWeight / largest_weight();
  if (options_.fixed_window == FixedWindow::kBox) find_fixed_bins();
}

/// No sample weighs more, wherever it is mapped to.
template <int Dim>
double MutualInformation<Dim>::largest_weight() const {
  const auto& weights = this->input().weights;
  double largest = *std::max_element(weights.begin(), weights.end());
  if (this->input().moving_mask != nullptr) {
    const IntensityRange mask = this->input().moving_mask->coefficient_range();
    largest *= std::max(std::abs(mask.lower), std::abs(mask.upper));
  }
  return largest > 0 ? largest : 1;
}

template <int Dim>
void MutualInformation<Dim>::find_fixed_bins() {
  const std::int64_t rows = this->fixed_raster().num_rows();
  fixed_bin_.resize(static_cast<std::size_t>(rows) * this->row_stride());
  parallel_for((rows + 15) / 16, [&](std::int64_t part) {
    for (std::int64_t r = 16 * part; r < std::min(rows, 16 * part + 16); ++r) {
      const Samples row = this->kept(r);
      std::uint8_t* bin = &fixed_bin_[static_cast<std::size_t>(r) * this->row_stride()];
      for (int i = row.begin; i < row.end; ++i) {
        const FixedShares shares(fixed_bins_.position(row.fixed[i]), FixedWindow::kBox);
        bin[i] = static_cast<std::uint8_t>(shares.first);
      }
    }
  });
}

/// Samples begin .. end-1 of a row.
template <int Dim>
HistogramRow MutualInformation<Dim>::histogram_row(const Samples& row, int begin, int end) const {
  HistogramRow result;
  result.count = end - begin;
  result.bins = options_.bins;
  result.weight = row.weight + begin;
  result.moving = row.moving + begin;
  result.moving_scale = single(moving_bins_);
  result.fixed = row.fixed + begin;
  result.fixed_scale = single(fixed_bins_);
  if (!fixed_bin_.empty()) {
    result.fixed_bin = &fixed_bin_[static_cast<std::size_t>(row.row) * this->row_stride() + begin];
  }
  return result;
}

template <int Dim>
double MutualInformation<Dim>::fixed_entropy() const {
  JointHistogram histogram(options_.bins);
  for (std::int64_t r = 0; r < this->fixed_raster().num_rows(); ++r) {
    const Samples row = this->kept(r);
    for (int i = row.begin; i < row.end; ++i) {
      const FixedShares shares(fixed_bins_.position(row.fixed[i]), options_.fixed_window);
      for (int n = 0; n < shares.count; ++n) {
        *histogram.row(shares.first + n) += row.weight[i] * shares.value[n];
      }
    }
  }
  histogram.normalise();
  return std::max(entropy(histogram.fixed_marginal()), 1e-3);
}

template <int Dim>
std::unique_ptr<typename Metric<Dim>::Sums> MutualInformation<Dim>::new_sums() const {
  return std::make_unique<HistogramSums<Dim>>(options_.bins);
}

template <int Dim>
void MutualInformation<Dim>::add(const Samples& row, typename Metric<Dim>::Sums& sums) const {
  auto& histogram = static_cast<HistogramSums<Dim>&>(sums);
  const auto kernel = cpu_has_avx2() ? avx2::add_to_histogram : baseline::add_to_histogram;
  for (int begin = row.begin; begin < row.end; begin += kHistogramCapacity) {
    const int end = std::min(row.end, begin + kHistogramCapacity);
    histogram.reserve(end - begin);
    kernel(histogram_row(row, begin, end), static_cast<float>(counts_per_weight_),
           histogram.counts.data());
  }
}

template <int Dim>
double MutualInformation<Dim>::summarise(
    std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) {
  JointHistogram total(options_.bins);
  for (const auto& tile : tiles) static_cast<const HistogramSums<Dim>&>(*tile).add_to(total);
  const double weight = total.normalise() / counts_per_weight_;
  const auto information = total.information(options_.kind);
  tabulate(information, weight > 0 ? 1 / weight : 0);
  return -information.value;
}

/// For t in [0, 1] behind bin l, sum_i slope[l - 1 + i] b3(i - 1 - t) and its derivative by t as polynomials
/// of t; the window never leaves the bins.
template <int Dim>
void MutualInformation<Dim>::tabulate(const JointHistogram::Information& information,
                                      double per_sample) {
  const auto bins = static_cast<std::size_t>(options_.bins);
  const double per_intensity = moving_bins_.per_intensity();
  const bool masked = this->input().moving_mask != nullptr;
  cells_.assign(4 * bins * bins, 0.0f);
  if (masked) start_.assign(bins * bins, 0.0f);
  for (std::size_t k = 0; k < bins; ++k) {
    const auto curvature =
        static_cast<float>(per_sample * per_intensity * per_intensity * information.curvature[k]);
    for (std::size_t l = 1; l + 2 < bins; ++l) {
      const double* s = &information.slope[k * bins + l - 1];
      const double polynomial[3] = {0.5 * (s[2] - s[0]), s[0] - 2 * s[1] + s[2],
                                    0.5 * (s[3] - s[0]) + 1.5 * (s[1] - s[2])};
      float* cell = &cells_[4 * (k * bins + l)];
      for (int n = 0; n < 3; ++n) cell[n] = static_cast<float>(-per_sample * polynomial[n]);
      cell[3] = curvature;
      if (masked) {
        start_[k * bins + l] = static_cast<float>(-per_sample * (s[0] + 4 * s[1] + s[2]) / 6);
      }
    }
  }
  mean_slope_ = static_cast<float>(-per_sample * information.mean_slope);
}

template <int Dim>
void MutualInformation<Dim>::differentiate(const Samples& row, const Slopes& out) const {
  InformationSlopes slopes;
  slopes.cells = cells_.data();
  slopes.by_moving = out.by_moving + row.begin;
  slopes.curvature = out.curvature + row.begin;
  if (out.by_weight != nullptr) {
    slopes.start = start_.data();
    slopes.mean = mean_slope_;
    slopes.by_weight = out.by_weight + row.begin;
  }
  const auto kernel = cpu_has_avx2() ? avx2::information_slopes : baseline::information_slopes;
  kernel(histogram_row(row, row.begin, row.end), slopes);
}

template <int Dim>
double MutualInformation<Dim>::reference(Reference& all) const {
  const double mean = this->fixed_statistics().mean;
  JointHistogram histogram(options_.bins);
  for (std::size_t i = 0; i < all.weight.size(); ++i) {
    if (all.weight[i] == 0) continue;
    add_sample(histogram,
               FixedShares(fixed_bins_.position(all.fixed[i] - mean), options_.fixed_window),
               CubicWindow(moving_bins_.position(all.moving[i])), all.weight[i]);
  }
  const double weight = histogram.normalise();
  const auto information = histogram.information(options_.kind);
  for (std::size_t i = 0; i < all.weight.size(); ++i) {
    const FixedShares fixed(fixed_bins_.position(all.fixed[i] - mean), options_.fixed_window);
    const CubicWindow moving(moving_bins_.position(all.moving[i]));
    double slope = 0, value = 0;
    for (int n = 0; n < fixed.count; ++n) {
      const double* table =
          &information
               .slope[static_cast<std::size_t>(fixed.first + n) * options_.bins + moving.first];
      slope += fixed.value[n] * taps(moving.slope, table);
      value += fixed.value[n] * taps(moving.value, table);
    }
    all.by_moving[i] = -all.weight[i] / weight * moving_bins_.per_intensity(all.moving[i]) * slope;
    all.by_weight[i] = -(value - information.mean_slope) / weight;
  }
  return -information.value;
}

template class MutualInformation<2>;
template class MutualInformation<3>;

}  // namespace crease

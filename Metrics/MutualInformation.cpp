#include "Metrics/MutualInformation.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"

namespace crease {
namespace {

template <int Dim>
struct HistogramSums final : Metric<Dim>::Sums {
  explicit HistogramSums(int bins) : histogram(bins) {}
  JointHistogram histogram;
};

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
  JointHistogram& histogram = static_cast<HistogramSums<Dim>&>(sums).histogram;
  for (int i = row.begin; i < row.end; ++i) {
    if (row.weight[i] == 0) continue;
    add_sample(histogram, FixedShares(fixed_bins_.position(row.fixed[i]), options_.fixed_window),
               CubicWindow(moving_bins_.position(row.moving[i])), row.weight[i]);
  }
}

template <int Dim>
double MutualInformation<Dim>::summarise(
    std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) {
  JointHistogram total(options_.bins);
  for (const auto& tile : tiles) total += static_cast<const HistogramSums<Dim>&>(*tile).histogram;
  const double weight = total.normalise();
  const auto information = total.information(options_.kind);
  const double per_sample = weight > 0 ? 1 / weight : 0;
  const double per_intensity = moving_bins_.per_intensity();
  slope_.resize(information.slope.size());
  for (std::size_t i = 0; i < slope_.size(); ++i) {
    slope_[i] = static_cast<float>(-per_sample * information.slope[i]);
  }
  mean_slope_ = static_cast<float>(-per_sample * information.mean_slope);
  curvature_.resize(information.curvature.size());
  for (std::size_t k = 0; k < curvature_.size(); ++k) {
    curvature_[k] =
        static_cast<float>(per_sample * per_intensity * per_intensity * information.curvature[k]);
  }
  return -information.value;
}

template <int Dim>
void MutualInformation<Dim>::differentiate(const Samples& row, const Slopes& out) const {
  for (int i = row.begin; i < row.end; ++i) {
    if (row.weight[i] == 0 && out.by_weight == nullptr) continue;
    const FixedShares fixed(fixed_bins_.position(row.fixed[i]), options_.fixed_window);
    const CubicWindow moving(moving_bins_.position(row.moving[i]));
    double slope = 0, value = 0, curvature = 0;
    for (int n = 0; n < fixed.count; ++n) {
      const int k = fixed.first + n;
      const float* table = &slope_[static_cast<std::size_t>(k) * options_.bins + moving.first];
      slope += fixed.value[n] * taps(moving.slope, table);
      if (out.by_weight != nullptr) value += fixed.value[n] * taps(moving.value, table);
      curvature += fixed.value[n] * curvature_[k];
    }
    out.by_moving[i] =
        static_cast<float>(row.weight[i] * moving_bins_.per_intensity(row.moving[i]) * slope);
    out.curvature[i] = static_cast<float>(row.weight[i] * curvature);
    if (out.by_weight != nullptr) out.by_weight[i] = static_cast<float>(value) - mean_slope_;
  }
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

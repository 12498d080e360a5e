#pragma once

#include <vector>

#include "Metrics/IntensityMetric.h"
#include "Metrics/JointHistogram.h"

namespace crease {

struct HistogramRow;

/// Window of the fixed image's intensities in the joint histogram. The moving image's is a cubic B-spline.
enum class FixedWindow {
  kBox,  ///< the nearest bin (Mattes et al., 2003)
  kCubic  ///< a cubic B-spline, too (Thevenaz and Unser, IEEE Transactions on Image Processing 9, 2000)
};

/// How mutual information is measured.
struct MutualInformationOptions {
  /// Per image, 8 to 256; four of them are padding. Few samples get fewer: four to a cell of the joint
  /// histogram on average.
  int bins = 32;
  FixedWindow fixed_window = FixedWindow::kBox;
  InformationKind kind = InformationKind::kMutual;
};

/// Mutual information by Parzen windows: for images of different modalities.
///
///     p(k, l) = 1/S sum_x w v(k - kappa_x) b3(l - iota_x),                    E = -I(p),
///     dE/dI_m = -w / (S D_m) sum_kl v(k - kappa_x) b3'(l - iota_x) dI/dp(k, l),
///
/// kappa_x and iota_x the positions of the intensities among the bins, D_m the width of a moving bin. The
/// range of the moving image is that of its spline coefficients in the mask, which no value leaves.
/// The curvature is Fisher's information on I_m in the distribution of its bin of the fixed image,
/// w / (S D_m^2) sum_l p(l | k) (d ln p(l | k) / dl)^2: for a Gaussian the reciprocal of its variance, as
/// Gauss-Newton's of squared differences in units of the noise.
///
/// Source: registration theory 4.1.
template <int Dim>
class MutualInformation final : public IntensityMetric<Dim> {
 public:
  /// @throws InvalidInput for a number of bins outside 8 to 256, when no sample has a weight, or when an
  /// image is constant where it counts.
  explicit MutualInformation(MetricInput<Dim> input, const MutualInformationOptions& options = {});

  std::string name() const override {
    return options_.kind == InformationKind::kMutual ? "mi" : "nmi";
  }
  std::unique_ptr<typename Metric<Dim>::Sums> new_sums() const override;
  /// The value times the number of samples is a negative log-likelihood: squared differences over twice the
  /// power of their noise. The unit takes that power for a thousandth of the range's square.
  double unit() const override { return unit_; }
  std::optional<double> noise_power() const override { return kNoisePower; }

 protected:
  using typename IntensityMetric<Dim>::Samples;
  using typename IntensityMetric<Dim>::Slopes;
  using typename IntensityMetric<Dim>::Reference;
  void add(const Samples& row, typename Metric<Dim>::Sums& sums) const override;
  double summarise(std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) override;
  void differentiate(const Samples& row, const Slopes& out) const override;
  double reference(Reference& all) const override;

 private:
  static constexpr double kNoisePower = 1e-3;
  double fixed_entropy() const;
  void find_fixed_bins();
  double largest_weight() const;
  HistogramRow histogram_row(const Samples& row, int begin, int end) const;
  void tabulate(const JointHistogram::Information& information, double per_sample);

  MutualInformationOptions options_;
  IntensityBins fixed_bins_, moving_bins_;
  double unit_ = 1;
  double counts_per_weight_ = 1;
  std::vector<std::uint8_t>
      fixed_bin_;  // of each sample, in rows of row_stride(), for a box window
  // Of the last evaluation, with all factors that samples share.
  std::vector<float> cells_;  // as InformationSlopes has them
  std::vector<float> start_;  // with a moving mask
  float mean_slope_ = 0;
};

extern template class MutualInformation<2>;
extern template class MutualInformation<3>;

}  // namespace crease

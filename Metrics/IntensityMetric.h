#pragma once

#include <memory>
#include <vector>

#include "Metrics/Metric.h"
#include "Metrics/MetricInput.h"

namespace crease {

/// A metric that is a function of intensities: E = E({w_x}, {f_x}, {m_x}), f_x = I_f(x), m_x = I_m(T(x)),
/// w_x the sample's weight times the moving mask's at T(x).
///
/// The first pass samples the moving image, keeps what it finds, and lets the metric add it to sums over
/// all samples; the second turns dE/dm_x and dE/dw_x into forces, F = dE/dm_x grad I_m + dE/dw_x w grad m,
/// and a curvature c_x >= 0 by m_x into G = c_x grad I_m grad I_m^T. What is kept makes the second pass
/// cheap, and allows one evaluation at a time.
template <int Dim>
class IntensityMetric : public Metric<Dim> {
 public:
  const Raster<Dim>& fixed_raster() const final { return input_.fixed.raster(); }
  int num_passes() const final { return 2; }
  int value_pass() const final { return 0; }
  bool needs_map(int pass) const final { return pass == 0; }
  void evaluate_row(int pass, const MappedRow<Dim>& row, const ForceRow<Dim>& out,
                    typename Metric<Dim>::Sums& sums) const final;
  double finish_pass(int pass,
                     std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) final;
  double evaluate(std::span<const Point<Dim>> mapped, std::span<Vector<Dim>> forces) const final;

 protected:
  using Sums = typename Metric<Dim>::Sums;

  /// Samples begin .. end-1 of one row, as arrays that are readable from begin - begin % 4 to end rounded
  /// up to 4, with weight 0 outside.
  struct Samples {
    std::int64_t row = 0;
    int begin = 0;
    int end = 0;
    const float* weight = nullptr;
    const float* fixed = nullptr;  ///< less the mean
    const float* moving = nullptr;
  };
  /// Of the same samples: dE/dm_x, a curvature >= 0, and dE/dw_x unless null. Up to three entries beside them
  /// may be written, too.
  struct Slopes {
    float* by_moving = nullptr;
    float* curvature = nullptr;
    float* by_weight = nullptr;
  };
  /// The same in double precision, for all samples of the raster.
  struct Reference {
    std::vector<double> weight, fixed, moving;
    std::vector<double> by_moving, by_weight;  ///< to be filled
  };

  /// Of the fixed image where it counts.
  struct FixedStatistics {
    double weight = 0;  ///< sum of the samples'
    double mean = 0, variance = 0;
    double lower = 0, upper = 0;
  };

  /// @throws InvalidInput as check(MetricInput).
  explicit IntensityMetric(MetricInput<Dim> input);

  /// Adds a row to the sums of its tile.
  virtual void add(const Samples& row, Sums& sums) const = 0;
  /// The value, from the sums of all tiles.
  virtual double summarise(std::span<const std::unique_ptr<Sums>> tiles) = 0;
  virtual void differentiate(const Samples& row, const Slopes& out) const = 0;
  /// Value and derivatives by plain formulas.
  virtual double reference(Reference& all) const = 0;

  const MetricInput<Dim>& input() const { return input_; }
  const FixedStatistics& fixed_statistics() const { return statistics_; }
  /// What the first pass has kept of a row: samples that it did not see have weight 0.
  Samples kept(std::int64_t row) const;
  /// Entries from one row to the next of arrays that are kept.
  std::size_t row_stride() const { return stride_; }

 private:
  struct Field {  // an image at the mapped points
    std::vector<float> value;
    std::array<std::vector<float>, Dim> gradient;
    void resize(std::size_t size);
  };
  void describe_fixed();
  std::size_t place(std::int64_t row) const;
  void sample(const MappedRow<Dim>& row, Sums& sums) const;
  void carry(const MappedRow<Dim>& row, const ForceRow<Dim>& out) const;

  MetricInput<Dim> input_;
  std::size_t stride_ = 0;
  double value_ = 0;
  FixedStatistics statistics_;
  std::vector<float> fixed_;  // less the mean; rows with room on both sides
  std::vector<float> weight_;
  mutable Field moving_, mask_;
  mutable std::vector<float> effective_;  // weights times the mask
};

extern template class IntensityMetric<2>;
extern template class IntensityMetric<3>;

}  // namespace crease

#pragma once

#include "Transforms/BoundGrid.h"

namespace crease {

/// Any spline basis bound to any raster: tables of the basis at every covered sample. Consecutive
/// samples with the same control points form a run that stores their numbers once and the weights as
/// [control point][sample], so that maps and adjoints sweep whole runs.
///
/// Memory: 4 bytes per sample and function that does not vanish there. Bases with more structure bind
/// themselves better (TensorBSplineGrid); this one is their reference and the fallback.
template <int Dim>
class SparseRowGrid final : public BoundGrid<Dim> {
 public:
  using typename BoundGrid<Dim>::Coefficients;
  using typename BoundGrid<Dim>::Accumulator;

  /// Evaluates the basis at every sample, in parallel; the basis is not needed afterwards.
  SparseRowGrid(const SplineBasis<Dim>& basis, const Raster<Dim>& raster);

  const Raster<Dim>& raster() const override { return raster_; }
  int num_control_points() const override { return num_control_points_; }
  std::pair<int, int> row_range(std::int64_t row) const override;
  void coverage(std::int64_t row, std::span<std::uint8_t> inside) const override;
  std::unique_ptr<Coefficients> prepare(
      const Eigen::Ref<const ControlPoints<Dim>>& control_points) const override;
  void map_row(const Coefficients& coefficients, std::int64_t row,
               const std::array<float*, Dim>& out) const override;
  std::unique_ptr<Accumulator> new_accumulator() const override;
  void add_row(Accumulator& sums, std::int64_t row,
               const std::array<const float*, Dim>& force) const override;
  void finish(std::span<const std::unique_ptr<Accumulator>> sums,
              Eigen::Ref<ControlPoints<Dim>> gradient) const override;
  void add_curvature(const CurvatureBlocks<Dim>& blocks, double scale,
                     BlockHessian<Dim>& hessian) const override;

 private:
  struct Run {
    int begin = 0, end = 0;          // samples
    std::size_t control_points = 0;  // first entry in Row::control_points
    std::size_t num_control_points = 0;
    std::size_t weights = 0;  // first entry in Row::weights
  };
  struct Row {
    std::vector<Run> runs;  // from left to right
    std::vector<int> control_points;
    std::vector<float> weights;
    std::span<const int> of(const Run& run) const {
      return {control_points.data() + run.control_points, run.num_control_points};
    }
  };
  struct BlockSample {  // a block of curvatures and the sample that stands for it
    const Row* row;
    const Run* run;
    int sample;
    std::size_t block;
  };
  Row build_row(const SplineBasis<Dim>& basis, std::int64_t row) const;
  std::vector<BlockSample> block_samples(const CurvatureBlocks<Dim>& blocks) const;

  Raster<Dim> raster_;
  int num_control_points_;
  std::vector<Row> rows_;
};

extern template class SparseRowGrid<2>;
extern template class SparseRowGrid<3>;

}  // namespace crease

#pragma once

#include <vector>

#include "Transforms/BoundGrid.h"
#include "Transforms/Splines/TriangularBSplineRows.h"

namespace crease {

/// A triangular B-spline on the samples of a raster.
///
/// Core samples lie in runs along rows: the triangle's polynomial is collapsed to one in X for the row
/// and evaluated by Horner's rule; its adjoint sums force times X^k, times Y^j, and ends in one product per
/// triangle. Strip samples are sparse rows. In single precision, agreement with evaluate() to 2e-6 of
/// the largest control point.
class TriangularBSplineGrid final : public BoundGrid<2> {
 public:
  /// Keeps nothing of the basis.
  TriangularBSplineGrid(const TriangularBSplineBasis<2>& basis,
                        const TriangularBSplineEvaluator& evaluator, const Raster<2>& raster);

  const Raster<2>& raster() const override { return raster_; }
  int num_control_points() const override { return num_control_points_; }
  std::pair<int, int> row_range(std::int64_t row) const override;
  void coverage(std::int64_t row, std::span<std::uint8_t> inside) const override;
  std::unique_ptr<Coefficients> prepare(
      const Eigen::Ref<const ControlPoints<2>>& control_points) const override;
  void map_row(const Coefficients& coefficients, std::int64_t row,
               const std::array<float*, 2>& out) const override;
  std::unique_ptr<Accumulator> new_accumulator() const override;
  void add_row(Accumulator& sums, std::int64_t row,
               const std::array<const float*, 2>& force) const override;
  void finish(std::span<const std::unique_ptr<Accumulator>> sums,
              Eigen::Ref<ControlPoints<2>> gradient) const override;
  void add_curvature(const CurvatureBlocks<2>& blocks, double scale,
                     BlockHessian<2>& hessian) const override;

  /// Samples in cores and in strips.
  std::int64_t num_core_samples() const;
  std::int64_t num_strip_samples() const;
  /// Memory of the strips' rows, bytes.
  std::int64_t strip_bytes() const;

 private:
  std::span<const GridRun> runs(std::int64_t row) const;
  GridRow kernel_row(std::int64_t row) const;
  int per_triangle() const { return (degree_ + 1) * core_stride(degree_); }
  std::int64_t count_samples(bool core) const;

  Raster<2> raster_;
  int degree_;
  int num_control_points_;
  bool avx2_;
  std::vector<int> points_of_triangle_;       // C(degree + 2, 2) per triangle
  std::vector<Eigen::MatrixXd> power_forms_;  // in index coordinates
  std::vector<GridPatch> patches_;
  std::vector<RowBand> bands_;
  std::unique_ptr<CurvatureGroups> curvature_;
};

}  // namespace crease

#pragma once

#include <memory>
#include <span>
#include <vector>

#include "Transforms/BoundGrid.h"
#include "Transforms/Splines/CurvatureGroups.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/TriangularBSplineGridKernels.h"

namespace crease {

/// A Powell-Sabin spline on the samples of a raster.
///
/// All samples lie in runs along rows, each in one small triangle: its quadratic is collapsed to one in X for
/// the row and evaluated by Horner's rule; the adjoint sums force times X^k, times Y^j, and ends in one
/// product per small triangle (the kernels of TriangularBSplineGrid's cores). In single precision, agreement with
/// evaluate() to 2e-6 of the largest control point.
class PowellSabinGrid final : public BoundGrid<2> {
 public:
  /// Keeps nothing of the basis.
  PowellSabinGrid(const PowellSabinBasis& basis, const Raster<2>& raster);

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
                     BlockHessian<2>& hessian) const override {
    curvature_->add(blocks, scale, hessian);
  }

 private:
  static constexpr int kMonomialCount = 6;
  using PowerForm = Eigen::Matrix<double, kMonomialCount, Eigen::Dynamic, Eigen::ColMajor,
                                  kMonomialCount, PowellSabinPatch::kMaxFunctions>;
  struct Cell {
    GridPatch place;
    PowerForm form;  // monomial by function of the triangle, in index coordinates
  };
  std::span<const GridRun> runs(std::int64_t row) const { return rows_[row]; }
  GridRow kernel_row(std::int64_t row) const;
  std::span<const int> points_of(std::size_t cell) const {
    return points_of_triangle_[cell / PowellSabinPatch::kNumCells];
  }
  static Cell cell_of(const PowellSabinPatch& patch, int number, const Raster<2>& raster);

  Raster<2> raster_;
  int num_control_points_;
  bool avx2_;
  std::vector<std::vector<int>> points_of_triangle_;
  std::vector<GridPatch> places_;  // of the small triangles: six per triangle of the mesh
  std::vector<PowerForm> forms_;
  std::vector<std::vector<GridRun>> rows_;
  std::unique_ptr<CurvatureGroups> curvature_;
};

}  // namespace crease

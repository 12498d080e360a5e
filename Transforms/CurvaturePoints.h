#pragma once

#include "Transforms/BoundGrid.h"

namespace crease {

/// Curvature of functions that all reach everywhere: the small blocks of samples of CurvatureBlocks gathered
/// into larger ones, about as large as the functions vary, with one point each. What is one row of few
/// entries per small block for local functions would be a full one for these.
template <int Dim>
class CurvaturePoints {
 public:
  /// @param step  wanted size of the larger blocks, mm; they are 1 small block at least along every axis.
  CurvaturePoints(const Raster<Dim>& raster, double step);

  /// The blocks' middles, mm, one column each.
  const ControlPoints<Dim>& points() const { return points_; }
  /// Component s of the curvatures (xx, xy, ...) summed over each block: one number per point.
  Eigen::VectorXd sums(const CurvatureBlocks<Dim>& blocks, int s) const;

 private:
  std::vector<int> group_;  // of each small block
  ControlPoints<Dim> points_;
};

/// Adds scale * sum_q sum_s g_s(q) w_i(q) w_k(q) for all pairs of functions: dense, as few matrix products.
/// @param weights  n x q: the functions at the points.
template <int Dim>
void add_dense_curvature(const CurvaturePoints<Dim>& points, const Eigen::MatrixXd& weights,
                         const CurvatureBlocks<Dim>& blocks, double scale,
                         BlockHessian<Dim>& hessian);

extern template class CurvaturePoints<2>;
extern template class CurvaturePoints<3>;

}  // namespace crease

#pragma once

#include <memory>

#include "Metrics/Metric.h"
#include "Registration/RowSubset.h"
#include "Transforms/AffineMap.h"
#include "Transforms/BoundGrid.h"

namespace crease {

/// E_I as a function of control points: a metric at the points T(x) = A(x) + sum_i phi_i B_i(x) of one
/// resolution level, in one fused sweep over tiles of rows: map, compare, carry the forces back.
///
/// Tiles do not depend on the number of threads and are summed in order, so neither do the results.
/// Source: registration theory 4.1 (similarity as a force field).
template <int Dim>
class ImageTerm {
 public:
  /// @param rows  the rows of samples to sweep over; samples of others must have no weight in the metric.
  /// @throws InvalidInput when the metric's fixed raster is not the one the grid is bound to.
  ImageTerm(std::shared_ptr<const BoundGrid<Dim>> grid, std::shared_ptr<Metric<Dim>> metric,
            AffineMap<Dim> affine, RowSubset rows = {});

  /// The metric's value; adds scale times its gradient (Dim x n) and curvature where not null.
  double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                  ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian);
  /// The same with the samples' curvature as it comes, in small blocks and not scaled.
  double evaluate_blocks(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                         ControlPoints<Dim>* gradient, CurvatureBlocks<Dim>* curvature);
  /// The largest |sum_i step_i B_i(x)| over the samples of every fourth row (of every row where
  /// the domain has few), in units of the smallest sample
  /// spacing.
  double largest_step(const Eigen::Ref<const ControlPoints<Dim>>& step) const;

  const Metric<Dim>& metric() const { return *metric_; }
  const std::shared_ptr<Metric<Dim>>& shared_metric() const { return metric_; }
  const BoundGrid<Dim>& grid() const { return *grid_; }
  const AffineMap<Dim>& affine() const { return affine_; }

 private:
  using Sums = std::unique_ptr<typename Metric<Dim>::Sums>;
  using Accumulator = std::unique_ptr<typename BoundGrid<Dim>::Accumulator>;
  struct Outputs;

  void sweep_tile(int pass, std::int64_t tile, const typename BoundGrid<Dim>::Coefficients& phi,
                  const Outputs& outputs, typename Metric<Dim>::Sums& sums,
                  typename BoundGrid<Dim>::Accumulator* accumulator) const;

  std::shared_ptr<const BoundGrid<Dim>> grid_;
  std::shared_ptr<Metric<Dim>> metric_;
  AffineMap<Dim> affine_;
  RowSubset rows_;
};

extern template class ImageTerm<2>;
extern template class ImageTerm<3>;

}  // namespace crease

#pragma once

#include <functional>

#include "Transforms/BoundGrid.h"
#include "Transforms/CurvaturePoints.h"
#include "Transforms/Splines/QuasiInterpolation.h"

namespace crease {

/// Functions that all reach everywhere, bound to a raster through a lattice: each is replaced by the cubic
/// B-spline that quasi-interpolates it (QuasiInterpolation). One dense product carries control points to
/// the lattice's, which map rows and collect forces as any tensor-product spline does; a table of all
/// functions at all samples would cost as many bytes and flops per sample as there are functions.
///
/// Memory: 8 bytes per function and lattice point. All samples are covered.
template <int Dim>
class LatticeGrid final : public BoundGrid<Dim> {
 public:
  using typename BoundGrid<Dim>::Coefficients;
  using typename BoundGrid<Dim>::Accumulator;
  /// The n functions at some points (Dim x q, mm): n x q.
  using Functions = std::function<Eigen::MatrixXd(const ControlPoints<Dim>& points)>;

  /// @param span  of the lattice, mm: a small part of the distance over which functions vary.
  /// @param step  between the points at which curvature is taken, mm: half of that distance.
  /// @throws InvalidInput when the functions on the lattice would need more than 4 GB.
  LatticeGrid(const Functions& functions, int num_functions, const Raster<Dim>& raster, double span,
              double step);

  const Raster<Dim>& raster() const override { return lattice_->raster(); }
  int num_control_points() const override { return static_cast<int>(to_lattice_.rows()); }
  std::pair<int, int> row_range(std::int64_t row) const override {
    return lattice_->row_range(row);
  }
  void coverage(std::int64_t row, std::span<std::uint8_t> inside) const override {
    lattice_->coverage(row, inside);
  }
  std::unique_ptr<Coefficients> prepare(
      const Eigen::Ref<const ControlPoints<Dim>>& control_points) const override;
  void map_row(const Coefficients& coefficients, std::int64_t row,
               const std::array<float*, Dim>& out) const override {
    lattice_->map_row(coefficients, row, out);
  }
  std::unique_ptr<Accumulator> new_accumulator() const override {
    return lattice_->new_accumulator();
  }
  void add_row(Accumulator& sums, std::int64_t row,
               const std::array<const float*, Dim>& force) const override {
    lattice_->add_row(sums, row, force);
  }
  void finish(std::span<const std::unique_ptr<Accumulator>> sums,
              Eigen::Ref<ControlPoints<Dim>> gradient) const override;
  /// At the middles of larger blocks (CurvaturePoints), with the functions themselves.
  void add_curvature(const CurvatureBlocks<Dim>& blocks, double scale,
                     BlockHessian<Dim>& hessian) const override;

 private:
  std::unique_ptr<BoundGrid<Dim>> lattice_;
  Eigen::MatrixXd to_lattice_;  // functions x lattice control points
  CurvaturePoints<Dim> curvature_points_;
  Eigen::MatrixXd at_points_;  // functions x curvature points
};

extern template class LatticeGrid<2>;
extern template class LatticeGrid<3>;

}  // namespace crease

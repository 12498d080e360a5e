#pragma once

#include "Transforms/BoundGrid.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/Splines/TensorBSplineKernels.h"

namespace crease {

/// A tensor-product B-spline bound to a raster whose axes run along its own.
///
/// A row of samples meets (degree + 1)^(Dim - 1) rows of the control net. They are added with their
/// weights once per row; along the row the map is then one polynomial per knot span, evaluated by
/// Horner's rule in full vectors, and the adjoint is its moments. Curvature is summed axis by axis
/// into one small matrix per span before it is scattered.
template <int Dim>
class TensorBSplineGrid final : public BoundGrid<Dim> {
 public:
  using typename BoundGrid<Dim>::Coefficients;
  using typename BoundGrid<Dim>::Accumulator;

  /// Whether the raster's axes are those of the lattice (same order and sense).
  static bool can_bind(const TensorLattice<Dim>& lattice, const Raster<Dim>& raster);

  /// @throws InvalidInput when can_bind() is false.
  TensorBSplineGrid(const TensorLattice<Dim>& lattice, int degree, const Raster<Dim>& raster);

  const Raster<Dim>& raster() const override { return raster_; }
  int num_control_points() const override;
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
  struct Axis {
    int begin = 0, end = 0;  // covered samples
    int net_size = 1;        // functions
    int num_spans = 1;
    std::vector<int> span;        // per sample
    std::vector<double> weights;  // per sample the degree + 1 values that do not vanish
  };
  /// The rows of the net that meet a row of samples.
  struct NetRows {
    int count = 0;
    std::array<int, (kMaxTensorDegree + 1) * (kMaxTensorDegree + 1)> number;
    std::array<double, (kMaxTensorDegree + 1) * (kMaxTensorDegree + 1)> weight;
  };
  bool covers(std::int64_t row) const;
  NetRows net_rows(std::int64_t row) const;
  TensorRowPlan plan() const;

  Raster<Dim> raster_;
  int degree_;
  std::array<Axis, Dim> axes_;
  std::vector<TensorRun> runs_;
  std::vector<float> local_;
  std::vector<double> polynomials_;
};

extern template class TensorBSplineGrid<2>;
extern template class TensorBSplineGrid<3>;

}  // namespace crease

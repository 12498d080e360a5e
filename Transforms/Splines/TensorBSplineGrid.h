#pragma once

#include "Transforms/BoundGrid.h"
#include "Transforms/Splines/KnotVector.h"
#include "Transforms/Splines/ParameterBox.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/Splines/TensorBSplineKernels.h"

namespace crease {

/// A tensor-product B-spline, uniform or with knots of its own, or rational, bound to a raster whose axes run
/// along its own.
///
/// A row of samples meets (degree + 1)^(Dim - 1) rows of the control net. They are added with their
/// weights once per row; along the row the map is then one polynomial per knot span, evaluated by
/// Horner's rule in full vectors, and the adjoint is its moments. Curvature is summed axis by axis
/// into one small matrix per span before it is scattered. Rational functions w_i N_i / W are the same with
/// control points times w_i and samples times 1 / W, which is kept for every sample.
template <int Dim>
class TensorBSplineGrid final : public BoundGrid<Dim> {
 public:
  using typename BoundGrid<Dim>::Coefficients;
  using typename BoundGrid<Dim>::Accumulator;

  /// Whether the raster's axes are those of the lattice (same order and sense).
  static bool can_bind(const TensorLattice<Dim>& lattice, const Raster<Dim>& raster);

  /// @throws InvalidInput when can_bind() is false.
  TensorBSplineGrid(const TensorLattice<Dim>& lattice, int degree, const Raster<Dim>& raster);

  /// The same for knots along the axes of a box.
  static bool can_bind(const ParameterBox<Dim>& box, const Raster<Dim>& raster);
  /// @param weights  w_i, first axis fastest; empty where they do not matter.
  /// @throws InvalidInput when can_bind() is false.
  TensorBSplineGrid(const std::array<KnotVector, Dim>& knots, const ParameterBox<Dim>& box,
                    const Eigen::VectorXd& weights, const Raster<Dim>& raster);

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
  /// Sizes of an axis without samples yet.
  void start_axis(int axis, int num_spans);
  /// Sample i lies in a span; its functions' values there.
  void place_sample(int axis, int i, int span, const BSplineSegment& segment);
  void make_runs();
  void make_inverse_weights();
  /// Blocks times 1 / W^2 at the sample that stands for each.
  CurvatureBlocks<Dim> divided_by_weight(const CurvatureBlocks<Dim>& blocks) const;
  bool covers(std::int64_t row) const;
  NetRows net_rows(std::int64_t row) const;
  TensorRowPlan plan() const;

  Raster<Dim> raster_;
  int degree_;
  std::array<Axis, Dim> axes_;
  std::vector<TensorRun> runs_;
  std::vector<float> local_;
  std::vector<double> polynomials_;
  int polynomials_per_span_ = 0;
  Eigen::VectorXd weights_;            // empty: not rational
  std::vector<float> inverse_weight_;  // per sample: 1 / W
};

extern template class TensorBSplineGrid<2>;
extern template class TensorBSplineGrid<3>;

}  // namespace crease

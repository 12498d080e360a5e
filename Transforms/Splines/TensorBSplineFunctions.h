#pragma once

#include <array>

#include "Transforms/Splines/SplineBasis.h"
#include "Transforms/Splines/TensorBSplineLattice.h"
#include "Transforms/Splines/TensorBSplineSegments.h"

namespace crease {

/// The matrix that turns packed second derivatives by t into those by x, where d/dx = P d/dt:
/// H_x = P H_t P^T, written for the distinct entries.
template <int Dim>
Matrix<kNumSecondDerivatives<Dim>> second_derivatives_transform(const Matrix<Dim>& p);

/// The (degree + 1)^Dim products of B-splines that do not vanish on a knot span of a lattice, first axis
/// fastest. They are the same on every span.
template <int Dim>
class TensorBSplineFunctions {
 public:
  TensorBSplineFunctions(const TensorLattice<Dim>& lattice, int degree);

  int count() const;
  /// Sets values and the derivatives asked for (in space, per mm) at a point of the span, in its own
  /// coordinates in [0, 1]; leaves the control points alone.
  void evaluate(const Vector<Dim>& local, int derivatives, BasisValues<Dim>& result) const;
  /// The same from functions of each axis; their derivatives are by the lattice's coordinates.
  void multiply(const std::array<BSplineSegment, Dim>& axes, int derivatives,
                BasisValues<Dim>& result) const;

 private:
  int degree_;
  Matrix<Dim> to_space_;                                // d/dx = to_space d/dt
  Matrix<kNumSecondDerivatives<Dim>> second_to_space_;  // the same for packed second derivatives
};

extern template Matrix<3> second_derivatives_transform(const Matrix<2>&);
extern template Matrix<6> second_derivatives_transform(const Matrix<3>&);
extern template class TensorBSplineFunctions<2>;
extern template class TensorBSplineFunctions<3>;

}  // namespace crease

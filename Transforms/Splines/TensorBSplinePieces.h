#pragma once

#include "Transforms/Splines/DeterminantPieces.h"
#include "Transforms/Splines/TensorBSplineLattice.h"

namespace crease {

/// det grad T of a tensor-product B-spline map on its knot spans: a product polynomial of degree
/// Dim * degree - 1 per axis. Along axis a the derivative is a B-spline of one degree less whose control values
/// are differences of control points over the spacing; their columns' hulls give the rough bound.
template <int Dim>
class TensorBSplinePieces final : public DeterminantPieces<Dim> {
 public:
  /// phi must outlive this.
  TensorBSplinePieces(const TensorLattice<Dim>& lattice, int degree, const ControlPoints<Dim>& phi,
                      const Matrix<Dim>& linear);

  int num_patches() const override;
  double rough_bound(int patch) const override;
  std::vector<DeterminantPiece<Dim>> pieces(int patch) const override;

 private:
  /// Control values on one span of column a of F Q, Q = direction^-T: degree of them along axis a, degree +
  /// 1 along the others, first axis fastest; Dim x as many.
  std::array<ControlPoints<Dim>, Dim> columns(int patch) const;
  std::array<int, Dim> column_degrees(int axis) const;

  TensorLattice<Dim> lattice_;
  int degree_;
  const ControlPoints<Dim>& phi_;
  Matrix<Dim> linear_;    // linear Q
  double determinant_q_;  // 1 or -1, but for rounding
};

extern template class TensorBSplinePieces<2>;
extern template class TensorBSplinePieces<3>;

}  // namespace crease

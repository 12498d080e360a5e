#pragma once

#include <functional>
#include <optional>

#include "Transforms/Splines/DeterminantPieces.h"

namespace crease {

/// A map P / W on a box, or parallelepiped, with product polynomials P and W of the same degree along every
/// axis, in Bernstein form.
template <int Dim>
struct BezierBox {
  Point<Dim> origin;
  Matrix<Dim> edges;  ///< a column per axis, mm: the box is origin + edges t, 0 <= t_a <= 1
  int degree = 1;
  ControlPoints<Dim> ordinates;  ///< of P, mm: (degree + 1)^Dim columns, first axis fastest
  Eigen::VectorXd weights;       ///< of W, likewise, all positive; empty: W = 1
};

/// det grad (P / W) of such a map. With W = 1 it is det P' / det(edges), the derivatives by t; else
///
///     det grad (P / W) = det [ W W' ; P P' ] / (W^(Dim + 1) det(edges)),
///
/// of which the numerator is given, divided by the largest weight to the power Dim + 1.
template <int Dim>
BoxPiece<Dim> bezier_piece(const BezierBox<Dim>& box);

/// det grad T of maps that are known box by box, one for every patch.
template <int Dim>
class BezierPieces final : public DeterminantPieces<Dim> {
 public:
  /// The map T on a patch; nothing where the patch is empty.
  using BoxOfPatch = std::function<std::optional<BezierBox<Dim>>(int patch)>;

  BezierPieces(int num_patches, BoxOfPatch box) : num_patches_(num_patches), box_(std::move(box)) {}

  int num_patches() const override { return num_patches_; }
  /// Infinite for empty patches.
  double rough_bound(int patch) const override;
  std::vector<DeterminantPiece<Dim>> pieces(int patch) const override;

 private:
  int num_patches_;
  BoxOfPatch box_;
};

extern template BoxPiece<2> bezier_piece(const BezierBox<2>&);
extern template BoxPiece<3> bezier_piece(const BezierBox<3>&);
extern template class BezierPieces<2>;
extern template class BezierPieces<3>;

}  // namespace crease

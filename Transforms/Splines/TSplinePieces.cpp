#include <memory>

#include "Transforms/Splines/BezierPieces.h"
#include "Transforms/Splines/TSplineBasis.h"

// Where T-spline maps are polynomials: one Bezier element after the other.

namespace crease {

std::unique_ptr<DeterminantPieces<2>> TSplineBasis::determinant_pieces(
    const ControlPoints<2>& phi, const Matrix<2>& linear) const {
  const ControlPoints<2> control_points = linear * greville_points() + phi;
  const auto box_of = [this, control_points](int patch) -> std::optional<BezierBox<2>> {
    const Element& element = elements_[static_cast<std::size_t>(patch)];
    const Vector<2> length = element.upper - element.lower;
    const int n = degree() + 1;
    ControlPoints<2> ordinates = ControlPoints<2>::Zero(2, Eigen::Index{n} * n);
    for (std::size_t f = 0; f < element.functions.size(); ++f) {
      const auto& [along_u, along_v] = element.ordinates[f];
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          ordinates.col(n * j + i) +=
              along_u[i] * along_v[j] * control_points.col(element.functions[f]);
        }
      }
    }
    return BezierBox<2>{box_.point(element.lower),
                        box_.direction * length.asDiagonal(),
                        degree(),
                        std::move(ordinates),
                        {}};
  };
  return std::make_unique<BezierPieces<2>>(static_cast<int>(elements_.size()), box_of);
}

}  // namespace crease

#include "Transforms/Splines/SplineBasis.h"

#include <limits>

#include "Core/Error.h"
#include "Transforms/Splines/DeterminantPieces.h"
#include "Transforms/Splines/SplineSampler.h"

namespace crease {

template <int Dim>
Point<Dim> SplineBasis<Dim>::nearest_point(const Point<Dim>& x) const {
  if (contains(x)) return x;
  const Box<Dim> box = bounds();
  Point<Dim> clamped = x.cwiseMax(box.lower).cwiseMin(box.upper);
  if (contains(clamped)) return clamped;

  const ControlPoints<Dim> anchors = greville_points();
  Point<Dim> inside = clamped;
  double best = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < anchors.cols(); ++i) {
    const double distance = (anchors.col(i) - x).squaredNorm();
    if (distance < best && contains(anchors.col(i))) {
      best = distance;
      inside = anchors.col(i);
    }
  }
  if (best == std::numeric_limits<double>::infinity()) {
    throw InvalidInput(
        "SplineBasis: no Greville point lies in the domain; its mesh is degenerate.");
  }
  Point<Dim> outside = clamped;
  for (int step = 0; step < 50; ++step) {
    const Point<Dim> middle = 0.5 * (inside + outside);
    (contains(middle) ? inside : outside) = middle;
  }
  return inside;
}

template <int Dim>
std::shared_ptr<const HessianPattern> SplineBasis<Dim>::pattern() const {
  std::call_once(kept_pattern_->made, [this] {
    kept_pattern_->pattern =
        std::make_shared<const HessianPattern>(num_control_points(), couplings());
  });
  return kept_pattern_->pattern;
}

template <int Dim>
std::unique_ptr<DeterminantPieces<Dim>> SplineBasis<Dim>::determinant_pieces(
    const ControlPoints<Dim>&, const Matrix<Dim>&) const {
  return nullptr;
}

template <int Dim>
std::unique_ptr<SplineSampler<Dim>> SplineBasis<Dim>::sampler(
    const Eigen::Ref<const Eigen::MatrixXd>&) const {
  return nullptr;
}

template class SplineBasis<2>;
template class SplineBasis<3>;

}  // namespace crease

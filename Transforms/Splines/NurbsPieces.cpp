#include <memory>

#include "Transforms/Splines/BezierPieces.h"
#include "Transforms/Splines/NurbsBasis.h"
#include "Transforms/Splines/TensorIndex.h"

// Where NURBS maps are quotients of polynomials: Bezier extraction, span by span.

namespace crease {

template <int Dim>
std::optional<BezierBox<Dim>> NurbsBasis<Dim>::bezier_box(
    int patch, const ControlPoints<Dim>& control_points) const {
  const auto span = unravel<Dim>(patch, num_spans());
  Vector<Dim> begin, length;
  for (int a = 0; a < Dim; ++a) {
    begin[a] = axes_[a].span_begin(span[a]);
    length[a] = axes_[a].span_length(span[a]);
  }
  if (!(length.minCoeff() > 0)) return std::nullopt;
  std::array<int, Dim> size;
  size.fill(net_.degree + 1);
  const int count = product<Dim>(size);
  Eigen::MatrixXd ordinates(count, count);  // function, ordinate
  for (int f = 0; f < count; ++f) {
    const auto function = unravel<Dim>(f, size);
    for (int o = 0; o < count; ++o) {
      const auto ordinate = unravel<Dim>(o, size);
      double product = 1;
      for (int a = 0; a < Dim; ++a) {
        product *= axes_[a].ordinates(span[a], function[a])[ordinate[a]];
      }
      ordinates(f, o) = product;
    }
  }
  std::vector<int> numbers;
  fill_control_points(span, numbers);
  ControlPoints<Dim> mapped = control_points(Eigen::all, numbers);
  BezierBox<Dim> box{box_.point(begin), box_.direction * length.asDiagonal(), net_.degree, {}, {}};
  if (rational_) {
    const Eigen::VectorXd weights = net_.weights(numbers);
    mapped = mapped * weights.asDiagonal();
    box.weights = ordinates.transpose() * weights;
  }
  box.ordinates = mapped * ordinates;
  return box;
}

template <int Dim>
std::unique_ptr<DeterminantPieces<Dim>> NurbsBasis<Dim>::determinant_pieces(
    const ControlPoints<Dim>& phi, const Matrix<Dim>& linear) const {
  if (!reproduces_affine_maps()) return nullptr;
  const ControlPoints<Dim> control_points = linear * greville_points() + phi;
  return std::make_unique<BezierPieces<Dim>>(
      product<Dim>(num_spans()),
      [this, control_points](int patch) { return bezier_box(patch, control_points); });
}

#define CREASE_INSTANTIATE(Dim)                                                         \
  template std::optional<BezierBox<Dim>> NurbsBasis<Dim>::bezier_box(                   \
      int, const ControlPoints<Dim>&) const;                                            \
  template std::unique_ptr<DeterminantPieces<Dim>> NurbsBasis<Dim>::determinant_pieces( \
      const ControlPoints<Dim>&, const Matrix<Dim>&) const;
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease

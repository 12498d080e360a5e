#include "Transforms/DisplacementFieldTransform.h"

#include <Eigen/LU>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/ParameterCheck.h"

namespace crease {
namespace {

template <int Dim>
Matrix<Dim> checked_inverse(const Raster<Dim>& raster) {
  double samples = 1;
  for (int a = 0; a < Dim; ++a) {
    samples *= raster.size[a];
    if (raster.size[a] < 1) {
      throw InvalidInput(message("DisplacementFieldTransform: axis ", a, " has ", raster.size[a],
                                 " samples; at least 1 is needed."));
    }
    if (!(raster.spacing[a] > 0) || !std::isfinite(raster.spacing[a])) {
      throw InvalidInput(message("DisplacementFieldTransform: the spacing of axis ", a, " is ",
                                 raster.spacing[a], " mm; it must be positive."));
    }
  }
  if (samples > 1e10) {
    throw InvalidInput(message("DisplacementFieldTransform: ", samples, " samples are too many."));
  }
  if (!raster.origin.allFinite() || !raster.direction.allFinite() ||
      std::abs(raster.direction.determinant()) < 1e-6) {
    throw InvalidInput(
        "DisplacementFieldTransform: the origin must be finite and the direction invertible.");
  }
  return raster.index_to_point().inverse();
}

}  // namespace

template <int Dim>
DisplacementFieldTransform<Dim>::DisplacementFieldTransform(const Raster<Dim>& raster)
    : raster_(raster),
      point_to_index_(checked_inverse(raster)),
      displacements_(ControlPoints<Dim>::Zero(Dim, raster.num_samples())) {}

template <int Dim>
DisplacementFieldTransform<Dim>::DisplacementFieldTransform(const Raster<Dim>& raster,
                                                            ControlPoints<Dim> displacements)
    : raster_(raster),
      point_to_index_(checked_inverse(raster)),
      displacements_(std::move(displacements)) {
  check_parameters("DisplacementFieldTransform", displacements_.reshaped(),
                   Dim * raster.num_samples());
}

template <int Dim>
bool DisplacementFieldTransform<Dim>::is_inside(const Vector<Dim>& index) const {
  for (int a = 0; a < Dim; ++a) {
    if (!(index[a] >= -0.5 && index[a] < raster_.size[a] - 0.5)) return false;
  }
  return true;
}

template <int Dim>
typename DisplacementFieldTransform<Dim>::Cell DisplacementFieldTransform<Dim>::locate(
    const Point<Dim>& x, Eigen::Matrix<double, kNumCorners, Dim>* slopes) const {
  const Vector<Dim> index = point_to_index_ * (x - raster_.origin);
  Cell cell;
  cell.inside = is_inside(index);
  if (!cell.inside) return cell;
  Eigen::Index first = 0, stride = 1;
  std::array<Eigen::Index, Dim> strides;
  Vector<Dim> local, slope;
  for (int a = 0; a < Dim; ++a) {
    const int last = raster_.size[a] - 1;
    const double clamped = std::clamp(index[a], 0.0, double(last));
    const int begin = std::min(static_cast<int>(clamped), std::max(0, last - 1));
    local[a] = clamped - begin;
    slope[a] = index[a] == clamped && last > 0 ? 1 : 0;
    first += begin * stride;
    strides[a] = last > 0 ? stride : 0;
    stride *= raster_.size[a];
  }
  for (int c = 0; c < kNumCorners; ++c) {
    cell.corners[c] = first;
    cell.weights[c] = 1;
    if (slopes != nullptr) slopes->row(c).setOnes();
    for (int a = 0; a < Dim; ++a) {
      const bool upper = (c >> a & 1) != 0;
      const double weight = upper ? local[a] : 1 - local[a];
      if (upper) cell.corners[c] += strides[a];
      cell.weights[c] *= weight;
      if (slopes == nullptr) continue;
      for (int b = 0; b < Dim; ++b) {
        (*slopes)(c, b) *= a != b ? weight : upper ? slope[a] : -slope[a];
      }
    }
  }
  return cell;
}

template <int Dim>
std::unique_ptr<Transform<Dim>> DisplacementFieldTransform<Dim>::clone() const {
  return std::make_unique<DisplacementFieldTransform>(*this);
}

template <int Dim>
Point<Dim> DisplacementFieldTransform<Dim>::map(const Point<Dim>& x) const {
  const Cell cell = locate(x);
  Point<Dim> y = x;
  if (!cell.inside) return y;
  for (int c = 0; c < kNumCorners; ++c) {
    y += cell.weights[c] * displacements_.col(cell.corners[c]);
  }
  return y;
}

template <int Dim>
Matrix<Dim> DisplacementFieldTransform<Dim>::spatial_jacobian(const Point<Dim>& x) const {
  return sample(x).jacobian;
}

template <int Dim>
typename Transform<Dim>::Sample DisplacementFieldTransform<Dim>::sample(const Point<Dim>& x) const {
  Eigen::Matrix<double, kNumCorners, Dim> slopes;
  const Cell cell = locate(x, &slopes);
  if (!cell.inside) return {x, Matrix<Dim>::Identity(), false};
  Vector<Dim> u = Vector<Dim>::Zero();
  Matrix<Dim> by_index = Matrix<Dim>::Zero();
  for (int c = 0; c < kNumCorners; ++c) {
    const auto corner = displacements_.col(cell.corners[c]);
    u += cell.weights[c] * corner;
    by_index += corner * slopes.row(c);
  }
  return {x + u, Matrix<Dim>::Identity() + by_index * point_to_index_, true};
}

template <int Dim>
bool DisplacementFieldTransform<Dim>::in_domain(const Point<Dim>& x) const {
  return is_inside(point_to_index_ * (x - raster_.origin));
}

template <int Dim>
Eigen::VectorXd DisplacementFieldTransform<Dim>::parameters() const {
  return displacements_.reshaped();
}

template <int Dim>
void DisplacementFieldTransform<Dim>::set_parameters(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  check_parameters("DisplacementFieldTransform", parameters, num_parameters());
  displacements_ = parameters.reshaped(Dim, displacements_.cols());
}

template <int Dim>
void DisplacementFieldTransform<Dim>::add_adjoint(std::span<const Point<Dim>> x,
                                                  std::span<const Vector<Dim>> forces,
                                                  Eigen::Ref<Eigen::VectorXd> gradient) const {
  check_adjoint("DisplacementFieldTransform", x.size(), forces.size(), gradient.size(),
                num_parameters());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Cell cell = locate(x[k]);
    if (!cell.inside) continue;
    for (int c = 0; c < kNumCorners; ++c) {
      gradient.template segment<Dim>(Dim * cell.corners[c]) += cell.weights[c] * forces[k];
    }
  }
}

template class DisplacementFieldTransform<2>;
template class DisplacementFieldTransform<3>;

}  // namespace crease

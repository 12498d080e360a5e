#include "Registration/InverseTransform.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "Core/Error.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/InverseMap.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SplineTransform.h"

namespace crease {
namespace {

template <int Dim>
PointMap<Dim> inverse_of_affine(const AffineMap<Dim>& map) {
  const Eigen::FullPivLU<Matrix<Dim>> lu(map.linear);
  if (!lu.isInvertible()) {
    throw InvalidInput("inverse: an affine part of the transform is singular and has no inverse.");
  }
  const Matrix<Dim> inverse = lu.inverse();
  return [inverse, offset = map.offset](const Point<Dim>& y) -> Point<Dim> {
    return inverse * (y - offset);
  };
}

/// Samples over the box of the spline's domain, a quarter of its mean edge length apart.
template <int Dim>
Raster<Dim> starting_points(const SplineBasis<Dim>& basis) {
  constexpr int kMostPerAxis = Dim == 2 ? 2048 : 160;
  const Box<Dim> box = basis.bounds();
  const double wanted = basis.mean_edge_length() / 4;
  Raster<Dim> raster;
  for (int a = 0; a < Dim; ++a) {
    const double length = box.size()[a];
    raster.size[a] = std::clamp(static_cast<int>(std::ceil(length / wanted)), 2, kMostPerAxis);
    raster.spacing[a] = length / raster.size[a];
    raster.origin[a] = box.lower[a] + raster.spacing[a] / 2;
  }
  return raster;
}

template <int Dim>
PointMap<Dim> inverse_of_spline(const SplineTransform<Dim>& spline) {
  const auto inverse =
      std::make_shared<const InverseMap<Dim>>(spline, starting_points(spline.basis()));
  return [inverse](const Point<Dim>& y) -> Point<Dim> {
    if (!y.allFinite()) return Point<Dim>::Constant(std::numeric_limits<double>::quiet_NaN());
    return (*inverse)(y);
  };
}

template <int Dim>
PointMap<Dim> inverse_of_chain(const CompositeTransform<Dim>& chain) {
  std::vector<PointMap<Dim>> inverses;
  for (std::size_t k = chain.num_parts(); k-- > 0;) {
    inverses.push_back(inverse_transform(chain.part(k)));
  }
  return [inverses](const Point<Dim>& y) {
    Point<Dim> x = y;
    for (const auto& inverse : inverses) x = inverse(x);
    return x;
  };
}

}  // namespace

template <int Dim>
PointMap<Dim> inverse_transform(const Transform<Dim>& transform) {
  if (const auto* affine = dynamic_cast<const AffineTransform<Dim>*>(&transform)) {
    return inverse_of_affine(affine->affine_map());
  }
  if (const auto* rigid = dynamic_cast<const RigidTransform<Dim>*>(&transform)) {
    return inverse_of_affine(rigid->affine_map());
  }
  if (const auto* spline = dynamic_cast<const SplineTransform<Dim>*>(&transform)) {
    return inverse_of_spline(*spline);
  }
  if (const auto* chain = dynamic_cast<const CompositeTransform<Dim>*>(&transform)) {
    return inverse_of_chain(*chain);
  }
  throw InvalidInput("inverse: transforms of this type cannot be inverted.");
}

template PointMap<2> inverse_transform<2>(const Transform<2>&);
template PointMap<3> inverse_transform<3>(const Transform<3>&);

}  // namespace crease

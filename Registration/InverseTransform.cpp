#include "Registration/InverseTransform.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/AffineEquivalent.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/DisplacementFieldTransform.h"
#include "Transforms/InverseMap.h"
#include "Transforms/SplineTransform.h"

namespace crease {
namespace {

template <int Dim>
constexpr int kMostPerAxis = Dim == 2 ? 2048 : 160;

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

/// Samples over a box, about as far apart as wanted, in the middle of their cells.
template <int Dim>
Raster<Dim> samples_over(const Box<Dim>& box, double wanted) {
  Raster<Dim> raster;
  for (int a = 0; a < Dim; ++a) {
    const double length = std::max(box.size()[a], wanted);
    const double count = std::ceil(length / wanted);
    raster.size[a] = static_cast<int>(std::clamp(count, 2.0, double(kMostPerAxis<Dim>)));
    raster.spacing[a] = length / raster.size[a];
    raster.origin[a] = (box.lower[a] + box.upper[a] - length + raster.spacing[a]) / 2;
  }
  return raster;
}

/// The field's samples, or every n-th of them where there are too many.
template <int Dim>
Raster<Dim> samples_of(const DisplacementFieldTransform<Dim>& field) {
  Raster<Dim> raster = field.raster();
  for (int a = 0; a < Dim; ++a) {
    const int step = (raster.size[a] + kMostPerAxis<Dim> - 1) / kMostPerAxis<Dim>;
    raster.size[a] = (raster.size[a] + step - 1) / step;
    raster.spacing[a] *= step;
  }
  return raster;
}

/// Around the points y that are asked for, moved by what T does to their middle.
template <int Dim>
Raster<Dim> samples_around(const Transform<Dim>& transform, const Box<Dim>& where) {
  constexpr int kPerAxis = Dim == 2 ? 256 : 48;
  if (where.empty()) {
    throw InvalidInput(
        "inverse: a transform of this class has no domain of its own; say where it is to be "
        "inverted.");
  }
  const Point<Dim> middle = 0.5 * (where.lower + where.upper);
  const Vector<Dim> shift = middle - transform.map(middle);
  const Vector<Dim> half = Vector<Dim>::Constant(std::max(0.75 * where.size().maxCoeff(), 1.0));
  Box<Dim> box;
  box.add(middle + shift - half);
  box.add(middle + shift + half);
  return samples_over(box, 2 * half[0] / kPerAxis);
}

template <int Dim>
Raster<Dim> starting_points(const Transform<Dim>& transform, const Box<Dim>& where) {
  if (const auto* spline = dynamic_cast<const SplineTransform<Dim>*>(&transform)) {
    return samples_over(spline->basis().bounds(), spline->basis().mean_edge_length() / 4);
  }
  if (const auto* field = dynamic_cast<const DisplacementFieldTransform<Dim>*>(&transform)) {
    return samples_of(*field);
  }
  return samples_around(transform, where);
}

/// Where a map takes a box, as far as some points of it tell.
template <int Dim>
Box<Dim> image_of(const Box<Dim>& box, const PointMap<Dim>& map) {
  constexpr int kPerAxis = 5;
  Box<Dim> image;
  if (box.empty()) return image;
  for (int n = 0; n < std::pow(kPerAxis, Dim); ++n) {
    Vector<Dim> share;
    for (int a = 0, rest = n; a < Dim; ++a, rest /= kPerAxis) {
      share[a] = rest % kPerAxis / (kPerAxis - 1.0);
    }
    const Point<Dim> x = map(box.lower + share.cwiseProduct(box.size()));
    if (x.allFinite()) image.add(x);
  }
  return image.empty() ? box : image;
}

template <int Dim>
PointMap<Dim> inverse_of_chain(const CompositeTransform<Dim>& chain, Box<Dim> where) {
  std::vector<PointMap<Dim>> inverses;
  for (std::size_t k = chain.num_parts(); k-- > 0;) {
    inverses.push_back(inverse_transform(chain.part(k), where));
    where = image_of(where, inverses.back());
  }
  return [inverses](const Point<Dim>& y) {
    Point<Dim> x = y;
    for (const auto& inverse : inverses) x = inverse(x);
    return x;
  };
}

}  // namespace

InverseResidual& InverseResidual::operator+=(const InverseResidual& other) {
  resolved += other.resolved;
  unresolved += other.unresolved;
  sum_mm += other.sum_mm;
  max_mm = std::max(max_mm, other.max_mm);
  return *this;
}

template <int Dim>
PointMap<Dim> inverse_transform(const Transform<Dim>& transform, const Box<Dim>& where) {
  if (const auto affine = affine_equivalent(transform)) return inverse_of_affine(*affine);
  if (const auto* chain = dynamic_cast<const CompositeTransform<Dim>*>(&transform)) {
    return inverse_of_chain(*chain, where);
  }
  const auto inverse =
      std::make_shared<const InverseMap<Dim>>(transform, starting_points(transform, where));
  return [inverse](const Point<Dim>& y) -> Point<Dim> { return (*inverse)(y); };
}

template <int Dim>
InverseResidual invert_points(const Transform<Dim>& transform, const PointMap<Dim>& inverse,
                              std::span<const Point<Dim>> y, std::span<Point<Dim>> x) {
  constexpr std::int64_t kBlock = 64;
  if (x.size() != y.size()) {
    throw InvalidInput(
        message("invert_points: ", y.size(), " points, but room for ", x.size(), " results."));
  }
  return parallel_sum(
      std::ssize(y), InverseResidual{},
      [&](std::int64_t k, InverseResidual& sum) {
        x[k] = inverse(y[k]);
        if (!x[k].allFinite()) {
          ++sum.unresolved;
          return;
        }
        const double distance = (transform.map(x[k]) - y[k]).norm();
        ++sum.resolved;
        sum.sum_mm += distance;
        sum.max_mm = std::max(sum.max_mm, distance);
      },
      kBlock);
}

#define CREASE_INSTANTIATE(Dim)                                                            \
  template PointMap<Dim> inverse_transform<Dim>(const Transform<Dim>&, const Box<Dim>&);   \
  template InverseResidual invert_points<Dim>(const Transform<Dim>&, const PointMap<Dim>&, \
                                              std::span<const Point<Dim>>, std::span<Point<Dim>>);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease

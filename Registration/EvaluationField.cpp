#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "Core/Parallel.h"
#include "Registration/Evaluation.h"

namespace crease {
namespace {

// du per step of index along the axis, at the index.
template <int Dim>
Vector<Dim> difference(const DisplacementField<Dim>& u, const std::array<int, Dim>& index,
                       int axis) {
  auto before = index, after = index;
  before[axis] = std::max(0, index[axis] - 1);
  after[axis] = std::min(u.size()[axis] - 1, index[axis] + 1);
  const int steps = after[axis] - before[axis];
  if (steps == 0) return Vector<Dim>::Zero();
  return (u[after] - u[before]) / steps;
}

}  // namespace

template <int Dim>
PointMap<Dim> displacement_map(const DisplacementField<Dim>& field) {
  const DisplacementField<Dim>* const u = &field;
  return [u](const Point<Dim>& x) -> Point<Dim> {
    constexpr double kRounding = 1e-9;
    const Vector<Dim> index = u->raster().index(x);
    std::array<int, Dim> base;
    Vector<Dim> share;
    for (int a = 0; a < Dim; ++a) {
      const int last = u->size()[a] - 1;
      const bool inside = index[a] >= -0.5 - kRounding && index[a] <= last + 0.5 + kRounding;
      if (!inside) return Point<Dim>::Constant(std::numeric_limits<double>::quiet_NaN());
      const double t = std::clamp(index[a], 0.0, static_cast<double>(last));
      base[a] = std::min(static_cast<int>(t), std::max(0, last - 1));
      share[a] = t - base[a];
    }
    Point<Dim> y = x;
    for (int corner = 0; corner < (1 << Dim); ++corner) {
      double weight = 1;
      auto at = base;
      for (int a = 0; a < Dim; ++a) {
        const int up = corner >> a & 1;
        weight *= up ? share[a] : 1 - share[a];
        at[a] += up;
      }
      if (weight > 0) y += weight * (*u)[at];
    }
    return y;
  };
}

template <int Dim>
Image<float, Dim> determinant_map(const DisplacementField<Dim>& field) {
  Image<float, Dim> result(field.raster());
  const Matrix<Dim> to_index = field.raster().point_to_index();
  parallel_for(field.raster().num_rows(), [&](std::int64_t row) {
    const std::int64_t first = row * field.size()[0];
    for (std::int64_t i = first; i < first + field.size()[0]; ++i) {
      Matrix<Dim> steps;
      for (int a = 0; a < Dim; ++a) steps.col(a) = difference<Dim>(field, field.index(i), a);
      const Matrix<Dim> gradient = Matrix<Dim>::Identity() + steps * to_index;
      result.values()[i] = static_cast<float>(gradient.determinant());
    }
  });
  return result;
}

template PointMap<2> displacement_map<2>(const DisplacementField<2>&);
template PointMap<3> displacement_map<3>(const DisplacementField<3>&);
template Image<float, 2> determinant_map<2>(const DisplacementField<2>&);
template Image<float, 3> determinant_map<3>(const DisplacementField<3>&);

}  // namespace crease

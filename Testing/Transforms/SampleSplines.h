#pragma once

#include <cmath>
#include <random>

#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease::testing {

/// Deterministic numbers in [-1, 1].
class Numbers {
 public:
  explicit Numbers(unsigned seed = 1) : engine_(seed) {}
  double operator()() { return uniform_(engine_); }
  template <int Rows>
  Matrix<Rows, Eigen::Dynamic> columns(Eigen::Index count, double size = 1) {
    return Matrix<Rows, Eigen::Dynamic>::NullaryExpr(Rows, count, [&] { return size * (*this)(); });
  }

 private:
  std::mt19937 engine_;
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

/// A rotation by 0.3 radians about the last axis (2D: in the plane).
template <int Dim>
Matrix<Dim> turned(double angle = 0.3) {
  Matrix<Dim> r = Matrix<Dim>::Identity();
  r.template topLeftCorner<2, 2>() << std::cos(angle), -std::sin(angle), std::sin(angle),
      std::cos(angle);
  return r;
}

/// 5 x 4 [x 3] spans of different sizes, off the origin, turned unless told otherwise.
template <int Dim>
TensorLattice<Dim> small_lattice(double angle = 0.3) {
  TensorLattice<Dim> lattice;
  const int spans[] = {5, 4, 3};
  const double spacing[] = {1.5, 2.0, 1.2};
  for (int a = 0; a < Dim; ++a) {
    lattice.spans[a] = spans[a];
    lattice.spacing[a] = spacing[a];
    lattice.origin[a] = 3.0 - 2 * a;
  }
  lattice.direction = turned<Dim>(angle);
  return lattice;
}

template <int Dim>
std::shared_ptr<const TensorBSplineBasis<Dim>> small_basis(int degree = 3, double angle = 0.3) {
  return std::make_shared<TensorBSplineBasis<Dim>>(small_lattice<Dim>(angle), degree);
}

/// A lattice over the box [0, size]^Dim.
template <int Dim>
std::shared_ptr<const TensorBSplineBasis<Dim>> box_basis(int spans, double size, int degree = 3) {
  TensorLattice<Dim> lattice;
  lattice.spans.fill(spans);
  lattice.spacing.setConstant(size / spans);
  return std::make_shared<TensorBSplineBasis<Dim>>(lattice, degree);
}

/// Points inside the lattice of a tensor basis, away from its border by the margin (in spans).
template <int Dim>
std::vector<Point<Dim>> points_inside(const TensorLattice<Dim>& lattice, int count,
                                      double margin = 0.01, unsigned seed = 5) {
  Numbers numbers(seed);
  std::vector<Point<Dim>> points;
  for (int n = 0; n < count; ++n) {
    Vector<Dim> t;
    for (int a = 0; a < Dim; ++a) {
      t[a] = margin + (0.5 + 0.5 * numbers()) * (lattice.spans[a] - 2 * margin);
    }
    points.push_back(lattice.point(t));
  }
  return points;
}

/// Control points of a displacement field x -> L x + t - x on any basis.
template <int Dim>
ControlPoints<Dim> affine_control_points(const SplineBasis<Dim>& basis, const AffineMap<Dim>& map) {
  ControlPoints<Dim> points = basis.greville_points();
  return ((map.linear - Matrix<Dim>::Identity()) * points).colwise() + map.offset;
}

}  // namespace crease::testing

#include "Transforms/SplineTransform.h"

#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Testing/Transforms/SampleBases.h"
#include "Testing/Transforms/SampleSplines.h"

namespace crease {
namespace {

template <int InDim, int OutDim>
SplineTransform<InDim, OutDim> random_transform() {
  SplineTransform<InDim, OutDim> transform(testing::small_basis<InDim>());
  transform.set_control_points(
      testing::Numbers().columns<OutDim>(transform.basis().num_control_points()));
  return transform;
}

template <int InDim, int OutDim>
void second_derivatives_match_differences() {
  const auto transform = random_transform<InDim, OutDim>();
  constexpr double kStep = 1e-5;
  const auto& basis = dynamic_cast<const TensorBSplineBasis<InDim>&>(transform.basis());
  for (const auto& x : testing::points_inside<InDim>(basis.lattice(), 10)) {
    const auto second = transform.second_derivatives(x);
    for (int b = 0; b < InDim; ++b) {
      Vector<InDim> h = Vector<InDim>::Zero();
      h[b] = kStep;
      const auto difference =
          ((transform.spatial_jacobian(x + h) - transform.spatial_jacobian(x - h)) / (2 * kStep))
              .eval();
      for (int c = 0; c < OutDim; ++c) {
        EXPECT_LT((second[c].col(b).transpose() - difference.row(c)).norm(), 1e-8);
      }
    }
  }
}

// <B phi, F> = <phi, B^T F>
template <int Dim>
void expect_transposed_adjoint() {
  Box<Dim> box;
  box.add(Point<Dim>::Zero());
  box.add(Point<Dim>::Constant(10));
  for (const auto& sample : testing::sample_bases<Dim>(box)) {
    SplineTransform<Dim> transform(sample.basis);
    testing::Numbers numbers(2);
    const Eigen::VectorXd phi = numbers.columns<1>(transform.num_parameters()).transpose();
    transform.set_parameters(phi);
    std::vector<Point<Dim>> x;
    std::vector<Vector<Dim>> forces;
    double forward = 0, size = 0;
    for (int k = 0; k < 200; ++k) {
      x.push_back(numbers.columns<Dim>(1, 5) + Vector<Dim>::Constant(5));
      forces.push_back(numbers.columns<Dim>(1));
      const double product = forces.back().dot(transform.map(x.back()) - x.back());
      forward += product;
      size += std::abs(product);
    }
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(phi.size());
    transform.add_adjoint(x, forces, gradient);
    EXPECT_NEAR(gradient.dot(phi), forward, 1e-13 * size) << sample.name;
  }
}

}  // namespace

TEST(SplineTransform, SecondDerivativesMatchCentralDifferences) {
  second_derivatives_match_differences<2, 2>();
  second_derivatives_match_differences<3, 3>();
  second_derivatives_match_differences<2, 3>();
}

TEST(SplineTransform, AddsTheSplineToTheAffinePart) {
  AffineMap<2> affine;
  affine.linear << 0, -1, 1, 0;
  affine.offset = {3, 4};
  SplineTransform<2> transform(testing::small_basis<2>(), affine);
  const Point<2> x =
      transform.basis().bounds().lower * 0.5 + transform.basis().bounds().upper * 0.5;
  EXPECT_LT((transform.map(x) - affine(x)).norm(), 1e-14);
  ControlPoints<2> shift = transform.control_points();
  shift.colwise() += Vector<2>(1, -2);
  transform.set_control_points(shift);
  EXPECT_LT((transform.map(x) - affine(x) - Vector<2>(1, -2)).norm(), 1e-13);
  EXPECT_LT((transform.spatial_jacobian(x) - affine.linear).norm(), 1e-13);
}

TEST(SplineTransform, AdjointIsTheTransposedMap) {
  expect_transposed_adjoint<2>();
  expect_transposed_adjoint<3>();
}

// Value and gradient go on across the border, along a straight line outside, by a quarter of a span at most.
TEST(SplineTransform, GoesOnOutsideByAQuarterOfASpan) {
  const auto transform = random_transform<2, 2>();
  const auto& lattice = dynamic_cast<const TensorBSplineBasis<2>&>(transform.basis()).lattice();
  const auto at = [&](double t) { return lattice.point({t, 1.7}); };
  EXPECT_FALSE(transform.in_domain(at(-1)));
  EXPECT_LT((transform.map(at(-1e-8)) - transform.map(at(1e-8))).norm(), 1e-6);
  EXPECT_LT((transform.spatial_jacobian(at(-1e-8)) - transform.spatial_jacobian(at(1e-8))).norm(),
            1e-6);
  const auto u = [&](double t) -> Vector<2> {
    return transform.map(at(t)) - transform.affine()(at(t));
  };
  const Matrix<2> gradient = transform.spatial_jacobian(at(0)) - transform.affine().linear;
  const double reach = transform.basis().mean_edge_length() / 4;
  for (double t : {-0.5, -1.0, -7.0, -1e6}) {
    const Vector<2> away = at(t) - at(0);
    const double s = reach / (reach + away.norm());
    EXPECT_LT((u(t) - (u(0) + s * gradient * away)).norm(), 1e-9);
    EXPECT_LE((u(t) - u(0)).norm(), reach * gradient.norm());
    const Vector<2> slope = (transform.spatial_jacobian(at(t)) - transform.affine().linear) * away;
    EXPECT_LT((slope - s * s * gradient * away).norm(), 1e-9 * away.norm());
  }
}

TEST(SplineTransform, StacksParametersByControlPoint) {
  auto transform = random_transform<2, 3>();
  const auto p = transform.parameters();
  EXPECT_EQ(p[3 * 5 + 2], transform.control_points()(2, 5));
}

TEST(SplineTransform, RefusesBadInput) {
  EXPECT_THROW(SplineTransform<2>(nullptr), InvalidInput);
  AffineMap<2> bad;
  bad.offset[0] = std::nan("");
  EXPECT_THROW(SplineTransform<2>(testing::small_basis<2>(), bad), InvalidInput);
  SplineTransform<2> transform(testing::small_basis<2>());
  EXPECT_THROW(transform.set_control_points(ControlPoints<2>::Zero(2, 3)), InvalidInput);
  EXPECT_THROW(transform.map({std::nan(""), 0}), InvalidInput);
}

}  // namespace crease

#include "Registration/Elastic/BorderConstraints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Testing/Registration/Elastic/ElasticBodies.h"
#include "Transforms/SplineTransform.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::shared_ptr<const TriangularBSplineBasis<2>> basis_with(const KnotOptions& options) {
  return std::make_shared<const TriangularBSplineBasis<2>>(
      place_knots(testing::half_ellipse(18), options).net);
}

Vector<2> quadratic(const Point<2>& p) {
  const double x = p.x() / 50, y = p.y() / 50;
  return {1 + x - 2 * y + x * x - x * y, 3 * x * y - y * y};
}

TEST(BorderConstraints, LagrangeElementsInterpolateQuadraticsEverywhere) {
  const auto basis = basis_with({.degree = 2, .collapse_all = true});
  SplineTransform<2> map(basis);
  map.set_control_points(interpolate_on_edges(*basis, quadratic));
  for (const Point<2>& x : {Point<2>(3, 5), Point<2>(41, -17.5), Point<2>(12, 30)}) {
    EXPECT_LT((map.map(x) - x - quadratic(x)).norm(), 1e-12);
  }
}

// Whatever the inside does: along an edge of the border only its three control points count.
TEST(BorderConstraints, HoldTheBorderWhereItsKnotsAreCollapsed) {
  const auto basis = basis_with({.degree = 2, .border = BorderRule::kCollapsed});
  const auto constraints = border_constraints(*basis, interpolate_on_edges(*basis, quadratic));
  ControlPoints<2> phi = ControlPoints<2>::Random(2, basis->num_control_points());
  for (Eigen::Index row = 0; row < constraints.num_rows(); ++row) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(constraints.C, row); it;
         ++it) {
      EXPECT_EQ(it.value(), 1);
      phi.col(it.col()) = constraints.d.row(row).transpose();
    }
  }
  SplineTransform<2> map(basis);
  map.set_control_points(phi);
  for (int y = -47; y < 47; y += 3) {  // the flat side
    const Point<2> x(0, y);
    EXPECT_LT((map.map(x) - x - quadratic(x)).norm(), 1e-11);
  }
}

// The patch test: an affine border has an affine inside, on which forces balance.
TEST(BorderConstraints, AffineBordersMoveTheBodyAffinely) {
  const Matrix<2> gradient{{0.06, -0.04}, {0.09, -0.05}};
  const auto basis = basis_with({.degree = 2, .border = BorderRule::kCollapsed});
  const auto affine = [&](const Point<2>& x) -> Vector<2> { return gradient * x; };
  ElasticMaterial material;
  material.law = ElasticLaw::kNeoHookean;
  const auto result =
      run_load_steps(ElasticEnergy<2>(*basis, material), *basis,
                     border_constraints(*basis, interpolate_on_edges(*basis, affine)));
  SplineTransform<2> map(basis);
  map.set_control_points(result.control_points);
  for (const Point<2>& x : {Point<2>(3, 5), Point<2>(41, -17.5), Point<2>(12, 30)}) {
    EXPECT_LT((map.map(x) - x - affine(x)).norm(), 1e-10);
  }
}

TEST(BorderConstraints, AreForQuadratics) {
  const auto basis = basis_with({.degree = 3});
  EXPECT_THAT([&] { interpolate_on_edges(*basis, quadratic); },
              ThrowsMessage<InvalidInput>(HasSubstr("degree 3; they are for degree 2")));
}

}  // namespace
}  // namespace crease

#include "Transforms/Energies/FoldingEnergy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "Core/Error.h"
#include "Testing/Transforms/Energies/EnergyChecks.h"
#include "Testing/Transforms/SampleBases.h"

namespace crease {
namespace {

template <int Dim>
Box<Dim> unit_box() {
  Box<Dim> box;
  box.add(Point<Dim>::Zero());
  box.add(Point<Dim>::Constant(4));
  return box;
}

}  // namespace

// An affine map of determinant d costs its area times (1 - d / delta)^4.
TEST(FoldingEnergy, OfAnAffineMapIsKnown) {
  const auto basis = testing::triangles_over(unit_box<2>(), {.degree = 3});
  const FoldingEnergy<2> energy(*basis, {}, {.threshold = 0.5});
  for (double det : {-1.0, 0.0, 0.2, 0.5, 0.9}) {
    AffineMap<2> map;
    map.linear << 2, 1, 0, det / 2;
    const auto phi = testing::affine_control_points(*basis, map);
    const double s = std::max(0.0, 1 - det / 0.5);
    EXPECT_NEAR(energy.evaluate(phi, 1, nullptr, nullptr), 16 * s * s * s * s, 1e-9) << det;
  }
  AffineMap<2> squeezed;  // the same as the affine part
  squeezed.linear << 2, 1, 0, 0.1;
  const FoldingEnergy<2> with_map(*basis, squeezed, {.threshold = 0.5});
  EXPECT_NEAR(with_map.evaluate(ControlPoints<2>::Zero(2, basis->num_control_points()), 1, nullptr,
                                nullptr),
              16 * std::pow(0.6, 4), 1e-9);
}

TEST(FoldingEnergy, CostsNothingWhereTheMapIsFarFromFolding) {
  const auto basis = testing::tensor_over<3>(unit_box<3>(), 2, 3);
  const FoldingEnergy<3> energy(*basis);
  const ControlPoints<3> phi = ControlPoints<3>::Zero(3, basis->num_control_points());
  ControlPoints<3> gradient = phi;
  BlockHessian<3> hessian(testing::pattern_of<3>(*basis));
  EXPECT_EQ(energy.evaluate(phi, 1, &gradient, &hessian), 0);
  EXPECT_EQ(gradient.norm(), 0);
  EXPECT_EQ(hessian.to_sparse().norm(), 0);
}

TEST(FoldingEnergy, CurvatureIsNeverNegative) {
  for (const auto& sample : testing::sample_bases<2>(unit_box<2>())) {
    const FoldingEnergy<2> energy(*sample.basis, {}, {.threshold = 0.5, .quadrature_degree = 2});
    const ControlPoints<2> phi =
        testing::Numbers(8).columns<2>(sample.basis->num_control_points(), 1.5);
    const Eigen::MatrixXd hessian = testing::dense_hessian<2>(energy, *sample.basis, phi);
    EXPECT_GT(hessian.norm(), 0.01) << sample.name;
    EXPECT_GT(testing::smallest_eigenvalue(hessian), -1e-10 * hessian.norm()) << sample.name;
    testing::expect_scaled<2>(energy, *sample.basis, phi);
  }
}

// Gauss-Newton leaves out p' d^2 det: nothing, along a path on which det is linear, as when only the first
// coordinate moves.
TEST(FoldingEnergy, CurvatureIsExactWhereTheDeterminantIsLinear) {
  const auto basis = testing::tensor_over<2>(unit_box<2>(), 3, 3);
  const FoldingEnergy<2> energy(*basis, {}, {.threshold = 0.9});
  ControlPoints<2> phi = testing::Numbers(8).columns<2>(basis->num_control_points(), 0.5);
  phi.row(1).setZero();
  ControlPoints<2> direction = testing::Numbers(9).columns<2>(basis->num_control_points());
  direction.row(1).setZero();
  const auto hessian = testing::dense_hessian<2>(energy, *basis, phi);
  const double expected = direction.reshaped().dot(hessian * direction.reshaped().eval());
  const double step = 1e-5;
  ControlPoints<2> plus = 0 * phi, minus = 0 * phi;
  energy.evaluate(phi + step * direction, 1, &plus, nullptr);
  energy.evaluate(phi - step * direction, 1, &minus, nullptr);
  EXPECT_NEAR((plus - minus).cwiseProduct(direction).sum() / (2 * step), expected, 1e-6 * expected);
}

TEST(FoldingEnergy, WatchesThePatchesAskedFor) {
  const auto basis = testing::tensor_over<2>(unit_box<2>(), 2, 2);
  AffineMap<2> flipped;
  flipped.linear(0, 0) = -0.1;  // det -0.1 everywhere: (1 + 1)^4 per area
  const FoldingEnergy<2> one(*basis, flipped, {.wanted = [](int, int p) { return p == 3; }});
  const ControlPoints<2> phi = ControlPoints<2>::Zero(2, basis->num_control_points());
  EXPECT_NEAR(one.evaluate(phi, 1, nullptr, nullptr), 4 * 16, 1e-9);
}

TEST(FoldingEnergy, RefusesWhatMakesNoSense) {
  const auto basis = testing::tensor_over<2>(unit_box<2>(), 2, 2);
  EXPECT_THROW(FoldingEnergy<2>(*basis, {}, {.threshold = 0}), InvalidInput);
  AffineMap<2> bad;
  bad.linear(0, 0) = std::nan("");
  EXPECT_THROW(FoldingEnergy<2>(*basis, bad), InvalidInput);
  const FoldingEnergy<2> energy(*basis);
  EXPECT_THAT([&] { energy.evaluate(ControlPoints<2>::Zero(2, 3), 1, nullptr, nullptr); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("3 control points")));
}

}  // namespace crease

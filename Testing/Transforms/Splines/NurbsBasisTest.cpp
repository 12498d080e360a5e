#include "Transforms/Splines/NurbsBasis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Testing/Transforms/SampleNurbs.h"
#include "Transforms/SplineProjection.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::Numbers;
using ::testing::ThrowsMessage;

template <int Dim>
std::vector<Point<Dim>> some_points(int count = 60) {
  return testing::points_inside<Dim>(testing::small_lattice<Dim>(), count, 0.0);
}

template <int Dim>
double largest_difference(const SplineBasis<Dim>& a, const Eigen::MatrixXd& of_a,
                          const SplineBasis<Dim>& b, const Eigen::MatrixXd& of_b) {
  double largest = 0;
  for (const auto& x : some_points<Dim>()) {
    const auto left = a.evaluate(x), right = b.evaluate(x);
    const Eigen::VectorXd u = of_a(Eigen::all, left.control_points) * left.values;
    const Eigen::VectorXd v = of_b(Eigen::all, right.control_points) * right.values;
    largest = std::max(largest, (u - v).norm());
  }
  return largest;
}

/// A quarter of the unit circle along u; not affine.
NurbsNet<2> quarter_circle() {
  NurbsNet<2> net;
  net.degree = 2;
  net.knots = {std::vector<double>{0, 0, 0, 1, 1, 1}, std::vector<double>{0, 0, 0, 1, 1, 1}};
  net.weights.setOnes(9);
  for (int j = 0; j < 3; ++j) net.weights[3 * j + 1] = std::sqrt(0.5);
  return net;
}

template <int Dim>
void knot_insertion_is_exact(const NurbsNet<Dim>& net) {
  const NurbsBasis<Dim> basis(net);
  const Eigen::MatrixXd phi = Numbers().columns<4>(basis.num_control_points());
  const double size = basis.box().upper[1];
  const double known = basis.net().knots[1][net.degree + 1];
  std::vector<double> knots = {0.37 * size, 0.9 * size};
  if (net.degree > 1) knots.push_back(known);
  const auto finer = insert_knots<Dim>(basis, phi, 1, knots);
  EXPECT_EQ(finer.basis->net_size()[1], basis.net_size()[1] + static_cast<int>(knots.size()));
  EXPECT_LT(largest_difference<Dim>(basis, phi, *finer.basis, finer.control_points), 1e-13);
  const auto halved = refined(basis, phi);
  EXPECT_LT(largest_difference<Dim>(basis, phi, *halved.basis, halved.control_points), 1e-13);
  // The identity is among the maps that stay.
  const auto identity = refined(basis, basis.greville_points());
  EXPECT_LT((identity.basis->greville_points() - identity.control_points).norm(), 1e-11);
}

}  // namespace

TEST(NurbsBasis, EqualWeightsGiveBSplines) {
  auto net = testing::nurbs_net(testing::small_lattice<2>(), 3);
  const NurbsBasis<2> plain(net);
  net.weights.setConstant(plain.num_control_points(), 0.1);
  const NurbsBasis<2> scaled(net);
  EXPECT_FALSE(scaled.is_rational());
  EXPECT_EQ(scaled.affine_error(), 0);
  for (const auto& x : some_points<2>()) {
    EXPECT_EQ(plain.evaluate(x, 2).hessians, scaled.evaluate(x, 2).hessians);
  }
}

// On even knots the clamped space is that of the uniform B-splines: they fit each other exactly.
TEST(NurbsBasis, SpansTheSpaceOfTheUniformSplines) {
  Raster<2> raster;
  raster.size = {40, 30};
  const auto uniform = std::make_shared<TensorBSplineBasis<2>>(covering_lattice(raster, 8.0));
  const NurbsBasis<2> clamped(covering_nurbs(raster, 8.0));
  EXPECT_EQ(clamped.num_control_points(), uniform->num_control_points());
  const auto moved =
      transfer<2>(uniform, Numbers().columns<2>(uniform->num_control_points()), clamped);
  EXPECT_LT(moved.max_error, 1e-12);
  const auto expected = raster.bounds();
  EXPECT_LT((clamped.bounds().lower - expected.lower).norm(), 1e-12);
  EXPECT_LT((clamped.bounds().upper - expected.upper).norm(), 1e-12);
}

TEST(NurbsBasis, KnotInsertionIsExact) {
  for (int degree : {1, 2, 3, 5}) {
    knot_insertion_is_exact(testing::nurbs_net(testing::small_lattice<2>(), degree));
    if (degree > 1)
      knot_insertion_is_exact(testing::rational_net(testing::small_lattice<2>(), degree));
  }
  knot_insertion_is_exact(testing::rational_net(testing::small_lattice<3>(), 2));
}

// ---- affine maps ----

// W of one degree less, with knots of its own where ours are double.
TEST(NurbsBasis, ElevatedWeightsKeepTheAffineMaps) {
  for (int degree : {2, 3, 4, 5}) {
    const auto net = testing::rational_net(testing::small_lattice<2>(), degree, 0.5);
    EXPECT_EQ(weight_axes(net)[0].num_functions(), degree + 1);  // a polynomial and one knot
    EXPECT_GT(net.weights.maxCoeff() / net.weights.minCoeff(), 1.3);
    const NurbsBasis<2> basis(net);
    EXPECT_TRUE(basis.is_rational());
    EXPECT_LT(basis.affine_error(), 1e-14);
  }
}

// The converse: a weight function of full degree has no identity, however small its part of degree n.
TEST(NurbsBasis, AnyOtherWeightDestroysThem) {
  for (double change : {1e-1, 1e-5, 1e-9}) {
    auto net = testing::rational_net(testing::small_lattice<2>(), 3);
    net.weights[11] *= 1 + change;
    EXPECT_THAT([&] { NurbsBasis<2>{net}; },
                ThrowsMessage<InvalidInput>(HasSubstr("elevated_weights")));
    const NurbsBasis<2> basis(net, AffineMaps::kNotNeeded);
    EXPECT_FALSE(basis.reproduces_affine_maps());
    EXPECT_GT(basis.affine_error(), 1e-5 * change);
    EXPECT_LT(basis.affine_error(), change);
    EXPECT_THROW(basis.greville_points(), InvalidInput);
  }
}

// The error said is a bound, and not a wild one: least squares finds no identity ten times better.
TEST(NurbsBasis, AffineErrorIsTheRightSize) {
  auto net = testing::nurbs_net(testing::small_lattice<2>(0.0), 2);
  net.weights.setOnes(NurbsBasis<2>(net).num_control_points());
  net.weights[9] = 1.2;
  const NurbsBasis<2> basis(net, AffineMaps::kNotNeeded);
  const auto best = project<2>(basis, [](const Point<2>& x) -> Vector<2> { return x; });
  const double length = (basis.box().upper - basis.box().lower).maxCoeff();
  EXPECT_LT(best.max_error, 2 * basis.affine_error() * length);
  EXPECT_GT(best.max_error, 0.1 * basis.affine_error() * length);
}

TEST(NurbsBasis, DrawsACircleWithoutAffineMaps) {
  EXPECT_THROW(NurbsBasis<2>{quarter_circle()}, InvalidInput);
  const NurbsBasis<2> basis(quarter_circle(), AffineMaps::kNotNeeded);
  Eigen::MatrixXd points(2, 9);
  for (int j = 0; j < 3; ++j) points.middleCols<3>(3 * j) << 1, 1, 0, 0, 1, 1;
  for (double u : {0.0, 0.2, 0.5, 0.9, 1.0}) {
    const auto b = basis.evaluate({u, 0.4});
    EXPECT_NEAR((points(Eigen::all, b.control_points) * b.values).norm(), 1, 1e-15);
  }
  const auto finer = insert_knots<2>(basis, points, 0, {0.3, 0.3});
  EXPECT_FALSE(finer.basis->reproduces_affine_maps());
  const auto b = finer.basis->evaluate({0.77, 0.1});
  EXPECT_NEAR((finer.control_points(Eigen::all, b.control_points) * b.values).norm(), 1, 1e-15);
}

// ---- integrals ----

// Products of second derivatives of rational functions, against three times the points.
TEST(NurbsBasis, QuadratureOfRationalFunctionsIsExactEnough) {
  for (double share : {0.05, 0.3, 0.6}) {
    const NurbsBasis<2> basis(testing::rational_net(testing::small_lattice<2>(), 3, share));
    EXPECT_GT(basis.product_degree(2, 2), 6);
    const auto integral = [&](int degree) {
      Eigen::MatrixXd sum =
          Eigen::MatrixXd::Zero(basis.num_control_points(), basis.num_control_points());
      for (const auto& e : basis.quadrature(degree, 2)) {
        for (const auto& h : e.hessians) {
          sum(e.control_points, e.control_points) += h * e.weights.asDiagonal() * h.transpose();
        }
      }
      return sum;
    };
    const int degree = basis.product_degree(2, 2);
    const Eigen::MatrixXd exact = integral(3 * degree);
    EXPECT_LT((integral(degree) - exact).norm(), 1e-10 * exact.norm()) << share;
  }
}

TEST(NurbsBasis, RepeatedKnotsLowerTheSmoothness) {
  auto net = testing::nurbs_net(testing::small_lattice<2>(0.0), 3);
  const NurbsBasis<2> basis(net);  // one double knot
  EXPECT_EQ(basis.smoothness(), 1);
  const double knot = net.knots[0][5];
  EXPECT_EQ(knot, net.knots[0][6]);
  const auto second = [&](double u) {
    const auto b = basis.evaluate(basis.box().point({u, 1.0}), 2);
    Eigen::VectorXd all = Eigen::VectorXd::Zero(basis.num_control_points());
    all(b.control_points) = b.hessians.row(0);
    return all;
  };
  EXPECT_GT((second(knot + 1e-9) - second(knot - 1e-9)).norm(), 1e-2);
  const double simple = net.knots[0][4];
  EXPECT_LT((second(simple + 1e-9) - second(simple - 1e-9)).norm(), 1e-7);
}

// ---- bad input ----

TEST(NurbsBasis, NamesWhatIsWrong) {
  const auto good = testing::nurbs_net(testing::small_lattice<2>(), 3);
  const auto expect = [](const NurbsNet<2>& net, const char* part) {
    EXPECT_THAT([&] { NurbsBasis<2>{net}; }, ThrowsMessage<InvalidInput>(HasSubstr(part)));
  };
  auto net = good;
  net.degree = 6;
  expect(net, "the degree is 6");
  net = good;
  std::swap(net.knots[1][4], net.knots[1][5]);
  net.knots[1][4] += 0.1;
  expect(net, "never decrease");
  net = good;
  net.knots[0].resize(7);
  expect(net, "7 knots; degree 3 needs at least 8");
  net = good;
  net.knots[0][3] += 0.01;
  expect(net, "the first 4 and the last 4 knots must be equal");
  net = good;
  net.knots[0].insert(net.knots[0].begin() + 5, 2, net.knots[0][5]);
  expect(net, "too often");
  net = good;
  net.knots[0].insert(net.knots[0].begin(), 0.0);
  expect(net, "too often");
  net = good;
  net.knots[1][4] = std::nan("");
  expect(net, "knot 4 is nan");
  net = good;
  net.weights.setOnes(5);
  expect(net, "5 weights given for");
  net.weights.setOnes(NurbsBasis<2>(good).num_control_points());
  net.weights[7] = -1;
  expect(net, "weight 7 is -1");
  net = good;
  net.direction(0, 0) = 3;
  expect(net, "orthonormal");

  const NurbsBasis<2> basis(good);
  const Eigen::MatrixXd phi = Eigen::MatrixXd::Zero(2, basis.num_control_points());
  EXPECT_THROW(basis.evaluate({1000, 0}), InvalidInput);
  EXPECT_THROW(basis.evaluate({std::nan(""), 0}), InvalidInput);
  EXPECT_THROW(insert_knots<2>(basis, phi.leftCols(3), 0, {1.0}), InvalidInput);
  EXPECT_THROW(insert_knots<2>(basis, phi, 2, {1.0}), InvalidInput);
  EXPECT_THROW(insert_knots<2>(basis, phi, 0, {-1.0}), InvalidInput);
  const double knot = good.knots[0][4];
  EXPECT_THROW(insert_knots<2>(basis, phi, 0, {knot, knot, knot}), InvalidInput);
  EXPECT_THROW(elevated_weights(good, Eigen::VectorXd::Ones(2)), InvalidInput);
  EXPECT_THROW(elevated_weights(good, -Eigen::VectorXd::Ones(16)), InvalidInput);
  EXPECT_THROW(covering_nurbs(Raster<2>(), 3.0), InvalidInput);
}

}  // namespace crease

#include "Transforms/Splines/TriangularBSplineBasis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "Core/Error.h"
#include "Testing/Transforms/Splines/Jumps.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/SimplexSplineGraph.h"

namespace crease {
namespace {

using testing::jittered_net;
using testing::points_inside;
using testing::special_points;
using testing::within_eight;

std::vector<Point<2>> all_points(const KnotNet<2>& net) {
  auto points = special_points(net);
  for (const auto& p : points_inside(net.mesh, 6, 99)) points.push_back(p);
  return points;
}

// Nets of every kind for one degree; the tolerances are meant for coordinates up to 8.
std::vector<KnotNet<2>> nets_of_degree(int degree) {
  return {within_eight(jittered_net(3, 3, degree, 0.3, 1)),
          within_eight(jittered_net(2, 3, degree, 0.5, 2)),
          within_eight(testing::straight_crease_net(degree, 0.4)),
          testing::ring_net(degree, 0.4, true), testing::ring_net(degree, 0.4, false)};
}

// sum_i c_i B_i with derivatives, c one column per component.
template <int Dim>
SplineJet<Dim> spline(const TriangularBSplineBasis<Dim>& basis, const Eigen::VectorXd& c,
                      const Point<Dim>& x) {
  const auto b = basis.evaluate(x, 2);
  SplineJet<Dim> jet;
  for (std::size_t i = 0; i < b.control_points.size(); ++i) {
    jet.value += c[b.control_points[i]] * b.values[i];
    jet.gradient += c[b.control_points[i]] * b.gradients.col(i);
    jet.hessian += c[b.control_points[i]] * b.hessians.col(i);
  }
  return jet;
}

TEST(TriangularBSplineBasis, FunctionsSumToOneEverywhere) {
  for (int degree = 1; degree <= 5; ++degree) {
    for (const auto& net : nets_of_degree(degree)) {
      const TriangularBSplineBasis<2> basis(net);
      for (const auto& x : all_points(net)) {
        const auto b = basis.evaluate(x, 2);
        EXPECT_NEAR(b.values.sum(), 1.0, 1e-10) << "degree " << degree << " at " << x.transpose();
        EXPECT_LT(b.gradients.rowwise().sum().norm(), 1e-9) << degree << " at " << x.transpose();
        EXPECT_LT(b.hessians.rowwise().sum().norm(), 1e-8) << degree << " at " << x.transpose();
        EXPECT_GT(b.values.minCoeff(), -1e-12);
        EXPECT_TRUE(std::is_sorted(b.control_points.begin(), b.control_points.end()));
      }
    }
  }
}

TEST(TriangularBSplineBasis, AgreesWithReferenceEvaluator) {
  for (int degree = 1; degree <= 5; ++degree) {
    for (const auto& net :
         {jittered_net(2, 3, degree, 0.5, 2), testing::straight_crease_net(degree, 0.4),
          testing::ring_net(std::min(degree, 3), 0.4, degree % 2 == 0)}) {
      const TriangularBSplineBasis<2> basis(net);
      const SimplexSplineGraph<2> graph(net.mesh, net.clouds, net.degree);
      const auto neighbours = vertex_neighbours(net.mesh);
      double value = 0.0, gradient = 0.0, hessian = 0.0, hessian_scale = 0.0;
      for (const auto& x : all_points(net)) {
        const int holder = basis.find_simplex(x);
        const auto flag = flag_towards<2>(simplex_centroid(net.mesh, holder), x);
        Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(6, basis.num_control_points());
        for (const auto& f : graph.evaluate(x, flag, neighbours[holder], 2)) {
          auto column = difference.col(basis.control_points_of(f.simplex)[f.index]);
          column[0] += f.jet.value;
          column.segment<2>(1) += f.jet.gradient;
          column.tail<3>() += f.jet.hessian;
        }
        hessian_scale = std::max(hessian_scale, difference.bottomRows(3).cwiseAbs().maxCoeff());
        const auto b = basis.evaluate(x, 2);
        for (std::size_t i = 0; i < b.control_points.size(); ++i) {
          auto column = difference.col(b.control_points[i]);
          column[0] -= b.values[i];
          column.segment<2>(1) -= b.gradients.col(i);
          column.tail<3>() -= b.hessians.col(i);
        }
        value = std::max(value, difference.row(0).cwiseAbs().maxCoeff());
        gradient = std::max(gradient, difference.middleRows(1, 2).cwiseAbs().maxCoeff());
        hessian = std::max(hessian, difference.bottomRows(3).cwiseAbs().maxCoeff());
      }
      EXPECT_LT(value, 1e-12) << "degree " << degree;
      EXPECT_LT(gradient, 1e-10) << "degree " << degree;
      EXPECT_LT(hessian, 1e-11 * std::max(1.0, hessian_scale)) << "degree " << degree;
    }
  }
}

TEST(TriangularBSplineBasis, IdentityIsReproducedByGrevillePoints) {
  for (int degree = 1; degree <= 5; ++degree) {
    for (const auto& net : nets_of_degree(degree)) {
      const TriangularBSplineBasis<2> basis(net);
      const auto points = basis.greville_points();
      for (const auto& x : all_points(net)) {
        for (int a = 0; a < 2; ++a) {
          const auto jet = spline<2>(basis, points.row(a), x);
          EXPECT_NEAR(jet.value, x[a], 1e-11);
          EXPECT_LT((jet.gradient - Vector<2>::Unit(a)).norm(), 1e-10);
          EXPECT_LT(jet.hessian.norm(), 1e-8);
        }
      }
    }
  }
}

TEST(TriangularBSplineBasis, PolynomialsAreReproducedByTheirPolarForms) {
  for (int degree = 1; degree <= 5; ++degree) {
    for (const auto& net : nets_of_degree(degree)) {
      const TriangularBSplineBasis<2> basis(net);
      const auto points = all_points(net);
      for (int i = 0; i <= degree; ++i) {
        const std::array<int, 2> exponents = {i, degree - i};
        const auto c = basis.control_values([&](std::span<const Point<2>> arguments) {
          return monomial_polar_form<2>(exponents, arguments);
        });
        double largest = 0.0, error = 0.0;
        for (const auto& x : points) {
          const double truth = std::pow(x[0], exponents[0]) * std::pow(x[1], exponents[1]);
          largest = std::max(largest, std::abs(truth));
          error = std::max(error, std::abs(spline<2>(basis, c, x).value - truth));
        }
        EXPECT_LT(error, 1e-11 * largest) << "x^" << i << " y^" << degree - i;
      }
    }
  }
}

TEST(TriangularBSplineBasis, IsBernsteinBasisWhenKnotsCollapse) {
  for (int degree = 1; degree <= 5; ++degree) {
    const auto net = testing::collapsed_knots(testing::jittered_mesh(2, 2, 7), degree);
    const TriangularBSplineBasis<2> basis(net);
    EXPECT_EQ(basis.smoothness(), 0);
    double factorial[6] = {1, 1, 2, 6, 24, 120};
    for (const auto& x : points_inside(net.mesh, 5, 3)) {
      const int t = basis.find_simplex(x);
      const auto v = simplex_corners(net.mesh, t);
      Eigen::VectorXd truth = Eigen::VectorXd::Zero(basis.num_control_points());
      const double whole = signed_content<2>(v);
      const double lambda[3] = {signed_content<2>({x, v[1], v[2]}) / whole,
                                signed_content<2>({v[0], x, v[2]}) / whole,
                                signed_content<2>({v[0], v[1], x}) / whole};
      const auto betas = multi_indices<2>(degree);
      for (std::size_t k = 0; k < betas.size(); ++k) {
        double value = factorial[degree];
        for (int j = 0; j < 3; ++j)
          value *= std::pow(lambda[j], betas[k][j]) / factorial[betas[k][j]];
        truth[basis.control_points_of(t)[k]] = value;
      }
      const auto b = basis.evaluate(x);
      for (std::size_t i = 0; i < b.control_points.size(); ++i) {
        truth[b.control_points[i]] -= b.values[i];
      }
      EXPECT_LT(truth.cwiseAbs().maxCoeff(), 1e-13) << "degree " << degree;
    }
  }
}

TEST(TriangularBSplineBasis, DerivativesMatchCentralDifferences) {
  for (int degree = 2; degree <= 5; ++degree) {
    const auto net = within_eight(jittered_net(3, 3, degree, 0.5, 4));
    const TriangularBSplineBasis<2> basis(net);
    const Eigen::VectorXd c =
        testing::random_control_values(1, basis.num_control_points(), 3).transpose();
    const double step = 1e-5;
    for (const auto& x : points_inside(net.mesh, 20, 21)) {
      const auto jet = spline<2>(basis, c, x);
      for (int a = 0; a < 2; ++a) {
        const Vector<2> e = step * Vector<2>(Vector<2>::Unit(a));
        if (!basis.contains(x + e) || !basis.contains(x - e)) continue;
        const auto p = spline<2>(basis, c, x + e), q = spline<2>(basis, c, x - e);
        EXPECT_NEAR(jet.gradient[a], (p.value - q.value) / (2 * step), 1e-5);
        if (degree < 3) continue;  // second derivatives that jump have no differences
        const Vector<2> row = (p.gradient - q.gradient) / (2 * step);
        for (int b = 0; b < 2; ++b) {
          EXPECT_NEAR(jet.hessian[second_derivative_index<2>(a, b)], row[b], 1e-3);
        }
      }
    }
  }
}

TEST(TriangularBSplineBasis, IsAffinelyInvariant) {
  const auto net = within_eight(jittered_net(3, 3, 3, 0.5, 4));
  const Matrix<2> A{{1.3, 0.4}, {-0.2, 0.9}};
  const Point<2> t(-120.0, 310.0);
  KnotNet<2> moved = net;
  for (auto& v : moved.mesh.vertices) v = A * v + t;
  for (auto& cloud : moved.clouds) {
    for (auto& knot : cloud) knot = A * knot + t;
  }
  const TriangularBSplineBasis<2> basis(net), other(moved);
  for (const auto& x : points_inside(net.mesh, 10, 2)) {
    const auto b = basis.evaluate(x), d = other.evaluate(A * x + t);
    Eigen::VectorXd difference = Eigen::VectorXd::Zero(basis.num_control_points());
    for (std::size_t i = 0; i < b.control_points.size(); ++i)
      difference[b.control_points[i]] += b.values[i];
    for (std::size_t i = 0; i < d.control_points.size(); ++i)
      difference[d.control_points[i]] -= d.values[i];
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-11);
  }
}

// The last knot t_n cancels between neighbours that share control points.
TEST(TriangularBSplineBasis, LastKnotDoesNotMatter) {
  for (int degree = 1; degree <= 5; ++degree) {
    const auto net = jittered_net(3, 3, degree, 0.4, 9);
    const TriangularBSplineBasis<2> basis(net);
    auto clouds = net.clouds;
    std::mt19937 random(4);
    std::uniform_real_distribution<double> shift(-0.8, 0.8);
    for (std::size_t v = 0; v < clouds.size(); ++v) {
      const auto& p = net.mesh.vertices[v];
      const bool inner = p.minCoeff() > 1e-9 && p.maxCoeff() < 30 - 1e-9;
      clouds[v].push_back(inner ? Point<2>(p[0] + shift(random), p[1] + shift(random)) : p);
    }
    const SimplexSplineGraph<2> graph(net.mesh, clouds, degree);
    const auto neighbours = vertex_neighbours(net.mesh);
    for (const auto& x : points_inside(net.mesh, 6, 5)) {
      const int holder = basis.find_simplex(x);
      const auto flag = flag_towards<2>(simplex_centroid(net.mesh, holder), x);
      Eigen::VectorXd difference = Eigen::VectorXd::Zero(basis.num_control_points());
      for (const auto& f : graph.evaluate(x, flag, neighbours[holder], 0)) {
        difference[basis.control_points_of(f.simplex)[f.index]] += f.jet.value;
      }
      const auto b = basis.evaluate(x);
      for (std::size_t i = 0; i < b.control_points.size(); ++i) {
        difference[b.control_points[i]] -= b.values[i];
      }
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-11) << "degree " << degree;
    }
  }
}

TEST(TriangularBSplineBasis, CoresHoldThePolynomialOfTheRecurrence) {
  for (int degree = 1; degree <= 5; ++degree) {
    const auto net = jittered_net(3, 3, degree, 0.4, 9);
    const TriangularBSplineBasis<2> basis(net);
    int in_core = 0;
    for (const auto& x : points_inside(net.mesh, 20, 5)) {
      const int t = basis.find_simplex(x);
      if (!basis.in_core(t, x)) continue;
      ++in_core;
      const auto flag = flag_towards<2>(simplex_centroid(net.mesh, t), x);
      const auto jets = basis.patch(t).evaluate(x, 0);
      for (int k = 0; k < num_multi_indices<2>(degree); ++k) {
        EXPECT_NEAR(jets(k, 0), testing::local_function<2>(net, t, k, x, flag).value, 1e-12);
      }
    }
    EXPECT_GT(in_core, 50);
  }
}

TEST(TriangularBSplineBasis, KnowsItsDomain) {
  const TriangularBSplineBasis<2> basis(jittered_net(3, 2, 3, 0.3, 1));
  EXPECT_NEAR(basis.measure(), 600.0, 1e-10);
  EXPECT_NEAR((basis.bounds().upper - Point<2>(30, 20)).norm(), 0.0, 1e-12);
  EXPECT_TRUE(basis.contains({0, 0}));
  EXPECT_TRUE(basis.contains({30, 20}));
  EXPECT_FALSE(basis.contains({30.001, 10}));
  EXPECT_FALSE(basis.contains({std::nan(""), 10}));
  EXPECT_GT(basis.mean_edge_length(), 10.0);
  EXPECT_LT(basis.mean_edge_length(), 13.0);
  EXPECT_LT((basis.nearest_point({35, 7}) - Point<2>(30, 7)).norm(), 1e-12);
  EXPECT_TRUE(basis.contains(basis.nearest_point({-3, 44})));
  EXPECT_THROW(basis.evaluate({31, 5}), InvalidInput);
}

TEST(TriangularBSplineBasis, TraceOnStraightBorderDependsOnBorderControlPointsAlone) {
  for (int degree = 2; degree <= 4; ++degree) {
    auto net = jittered_net(3, 3, degree, 0.4, 1);
    for (std::size_t v = 0; v < net.clouds.size(); ++v) {
      const auto& p = net.mesh.vertices[v];
      const bool left_right = p[0] < 1e-9 || p[0] > 30 - 1e-9,
                 low_high = p[1] < 1e-9 || p[1] > 30 - 1e-9;
      if (!left_right && !low_high) continue;
      for (int k = 1; k < degree; ++k) {
        const double r = left_right && low_high ? 0.0 : (k % 2 ? 0.8 : -0.6);
        net.clouds[v][k] = p + r * (left_right ? Vector<2>(0, 1) : Vector<2>(1, 0));
      }
    }
    const TriangularBSplineBasis<2> basis(net);
    const auto greville = basis.greville_points();
    for (int n = 0; n < 18; ++n) {
      const auto b = basis.evaluate({0.3 + 1.7 * n, 0.0});
      for (std::size_t i = 0; i < b.control_points.size(); ++i) {
        if (greville(1, b.control_points[i]) > 1e-6) EXPECT_LT(std::abs(b.values[i]), 1e-12);
      }
    }
  }
}

TEST(TriangularBSplineBasis, WorksInSpace) {
  for (int degree = 1; degree <= 3; ++degree) {
    const auto net = testing::tetrahedral_net(degree, 0.4);
    const TriangularBSplineBasis<3> basis(net);
    const auto identity = basis.greville_points();
    auto points = points_inside(net.mesh, 6, 17);
    for (const auto& p : net.mesh.vertices) points.push_back(p);
    points.emplace_back(5, 0, 5);
    points.emplace_back(10, 10, 2.5);
    for (const auto& x : points) {
      const auto b = basis.evaluate(x, 2);
      EXPECT_NEAR(b.values.sum(), 1.0, 1e-10) << "degree " << degree << " at " << x.transpose();
      EXPECT_LT(b.gradients.rowwise().sum().norm(), 1e-9);
      EXPECT_LT(b.hessians.rowwise().sum().norm(), 1e-8);
      EXPECT_GT(b.values.minCoeff(), -1e-12);
      for (int a = 0; a < 3; ++a) {
        const auto jet = spline<3>(basis, identity.row(a), x);
        EXPECT_NEAR(jet.value, x[a], 1e-11);
        EXPECT_LT((jet.gradient - Vector<3>::Unit(a)).norm(), 1e-10);
        EXPECT_LT(jet.hessian.norm(), 1e-8);
      }
    }
    EXPECT_NEAR(basis.measure(), 1000.0, 1e-9);
    EXPECT_THROW(basis.quadrature(2, 0), InvalidInput);
    EXPECT_THROW(basis.bind(Raster<3>()), InvalidInput);
    EXPECT_FALSE(basis.couplings().empty());
  }
}

TEST(TriangularBSplineBasis, RefusesNetsThatCannotWork) {
  const auto good = jittered_net(3, 3, 3, 0.4, 1);
  const auto expect_refusal = [&](const char* words, auto change) {
    auto net = good;
    change(net);
    EXPECT_THAT([&] { TriangularBSplineBasis<2>{net}; },
                ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr(words)));
  };
  expect_refusal("degree 6", [](auto& net) { net.degree = 6; });
  expect_refusal("vertex 5", [](auto& net) { net.clouds[5].pop_back(); });
  expect_refusal("vertex 6", [](auto& net) { net.clouds[6][1][0] = std::nan(""); });
  expect_refusal("15 clouds for 16 vertices", [](auto& net) { net.clouds.pop_back(); });
  expect_refusal("names vertex 77", [](auto& net) { net.mesh.simplices[2][1] = 77; });
  expect_refusal("triangle 3",
                 [](auto& net) { std::swap(net.mesh.simplices[3][0], net.mesh.simplices[3][1]); });
  expect_refusal("vertex 16 belongs to no simplex", [](auto& net) {
    net.mesh.vertices.emplace_back(5, 5);
    net.clouds.emplace_back(3, Point<2>(5, 5));
  });
  expect_refusal("make its clouds smaller", [](auto& net) {
    for (int k = 1; k < 3; ++k)
      net.clouds[5][k] = net.clouds[5][0] + 8.0 * (net.clouds[5][k] - net.clouds[5][0]);
  });
  expect_refusal("border knots must lie outside",
                 [](auto& net) { net.clouds[1][1] = net.clouds[1][0] + Vector<2>(0, 1); });
  expect_refusal("no edge of the mesh", [](auto& net) { net.crease_edges = {{{0, 15}, false}}; });
  expect_refusal("is not the vertex", [](auto& net) { net.clouds[5][0][0] += 1.0; });
}

}  // namespace
}  // namespace crease

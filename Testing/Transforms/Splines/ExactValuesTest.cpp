// Splines against exact rational arithmetic: what the files of reference vectors do, without them.
#include <gtest/gtest.h>

#include <random>

#include "Testing/Transforms/Splines/ExactSimplexSpline.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

using testing::ExactJet;
using testing::ExactSimplexSpline;
using testing::JetErrors;

template <int Dim>
Point<Dim> random_point(std::mt19937& random) {
  std::uniform_int_distribution<int> eighth(0, 32);
  Point<Dim> p;
  for (int a = 0; a < Dim; ++a) p[a] = eighth(random) / 8.0;
  return p;
}

/// Generic knots, or some of them repeated, or some on one line.
template <int Dim>
std::vector<Point<Dim>> some_knots(int degree, int kind, std::mt19937& random) {
  std::vector<Point<Dim>> knots;
  for (int i = 0; i < degree + Dim + 1; ++i) knots.push_back(random_point<Dim>(random));
  if (kind == 1 && degree > 0) knots[Dim + 1] = knots[0];
  if (kind == 2 && degree > 0) knots[Dim + 1] = 0.5 * (knots[0] + knots[1]);
  return knots;
}

/// Points inside the hull: a mean of all knots (weights that round to nothing special), the middle of two
/// knots, and a knot.
template <int Dim>
std::vector<Point<Dim>> points_for(const std::vector<Point<Dim>>& knots) {
  Point<Dim> mean = Point<Dim>::Zero();
  double sum = 0;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const double weight = 1.0 + static_cast<double>(i * i % 5);
    mean += weight * knots[i];
    sum += weight;
  }
  return {mean / sum, 0.5 * (knots.front() + knots.back()), knots[1]};
}

template <int Dim>
void check_simplex_splines(int largest_degree) {
  std::mt19937 random(7);
  for (int degree = 0; degree <= largest_degree; ++degree) {
    JetErrors errors;
    for (int kind = 0; kind < 3; ++kind) {
      const auto knots = some_knots<Dim>(degree, kind, random);
      std::vector<testing::ExactPoint<Dim>> exact_knots;
      for (const auto& knot : knots) exact_knots.push_back(testing::exact<Dim>(knot));
      for (const auto& u : points_for<Dim>(knots)) {
        const auto flag = flag_towards<Dim>(Point<Dim>::Constant(1.875), u);
        testing::add_errors<Dim>(simplex_spline<Dim>(knots, u, flag),
                                 ExactSimplexSpline<Dim>(u, flag).evaluate(exact_knots), errors);
      }
    }
    EXPECT_GT(errors.scale[0], 0.0);
    errors.expect_small("dimension " + std::to_string(Dim) + ", degree " + std::to_string(degree));
  }
}

/// The net with all numbers rounded to 1/64: short fractions keep exact arithmetic fast.
template <int Dim>
KnotNet<Dim> rounded(KnotNet<Dim> net) {
  const auto round = [](Point<Dim>& p) { p = (64.0 * p).array().round() / 64.0; };
  for (auto& v : net.mesh.vertices) round(v);
  for (auto& cloud : net.clouds) {
    for (auto& knot : cloud) round(knot);
  }
  return net;
}

/// Every B_i at the points, sums of local functions over the whole mesh.
template <int Dim>
void check_basis(const KnotNet<Dim>& net, const std::vector<Point<Dim>>& points,
                 const std::string& name) {
  const TriangularBSplineBasis<Dim> basis(net);
  const auto betas = multi_indices<Dim>(net.degree);
  JetErrors errors;
  for (const auto& u : points) {
    const auto flag = flag_towards<Dim>(simplex_centroid(net.mesh, basis.find_simplex(u)), u);
    const ExactSimplexSpline<Dim> spline(u, flag);
    std::vector<ExactJet<Dim>> truth(basis.num_control_points());
    for (int t = 0; t < static_cast<int>(net.mesh.simplices.size()); ++t) {
      for (std::size_t k = 0; k < betas.size(); ++k) {
        truth[basis.control_points_of(t)[k]].add(
            1, testing::exact_local_function<Dim>(net, t, betas[k], spline));
      }
    }
    std::vector<SplineJet<Dim>> found(truth.size());
    const auto b = basis.evaluate(u, 2);
    for (std::size_t i = 0; i < b.control_points.size(); ++i) {
      auto& jet = found[b.control_points[i]];
      jet.value = b.values[i];
      jet.gradient = b.gradients.col(i);
      jet.hessian = b.hessians.col(i);
    }
    testing::Rational sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      sum += truth[i].value;
      testing::add_errors<Dim>(found[i], truth[i], errors);
    }
    EXPECT_EQ(sum, 1) << name << " at " << u.transpose();
  }
  errors.expect_small(name);
}

}  // namespace

TEST(ExactValues, SimplexSplinesInThePlane) { check_simplex_splines<2>(5); }
TEST(ExactValues, SimplexSplinesInSpace) { check_simplex_splines<3>(4); }

// Core, strip, vertex, edge, inner knot, border and corner of the domain.
TEST(ExactValues, TriangularBasis) {
  for (int degree = 1; degree <= 3; ++degree) {
    const auto net = rounded(testing::jittered_net(2, 2, degree, 0.5, 4));
    check_basis<2>(net,
                   {{6.5, 3.25},
                    {9.75, 8.5},
                    net.mesh.vertices[4],
                    0.5 * (net.mesh.vertices[4] + net.mesh.vertices[0]),
                    net.clouds[4].back(),
                    {5.5, 0.0},
                    {20.0, 0.0}},
                   "degree " + std::to_string(degree));
  }
}

TEST(ExactValues, TriangularBasisWithACrease) {
  const auto net = rounded(testing::straight_crease_net(3, 0.4));
  check_basis<2>(net, {{20.0, 13.0}, net.clouds[12][1], {19.5, 22.25}}, "crease");
}

TEST(ExactValues, TetrahedralBasis) {
  const auto net = rounded(testing::tetrahedral_net(2, 0.4));
  check_basis<3>(net, {{4.5, 3.25, 6.0}, net.mesh.vertices[8], {5.0, 5.0, 0.0}, {5.25, 4.75, 4.5}},
                 "tetrahedra");
}

}  // namespace crease

// What the theory of feature lines promises of creases on curved outlines, whatever is fitted to them.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "Testing/Transforms/CreasedDomains.h"
#include "Testing/Transforms/Splines/Jumps.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/SplineProjection.h"

namespace crease {
namespace {

using testing::Jumps;

std::vector<Point<2>> all_points(const KnotNet<2>& net) {
  auto points = testing::special_points(net);
  for (const auto& p : testing::points_inside(net.mesh, 4, 99)) points.push_back(p);
  return points;
}

double power(double x, int n) { return std::pow(x, n); }

}  // namespace

/// One kind of crease; the suite runs over all of them.
class CreaseConstruction : public ::testing::TestWithParam<testing::CreasedDomain> {
 protected:
  static PlacedKnots placed(int degree) { return place_knots(GetParam().mesh, {.degree = degree}); }
};

INSTANTIATE_TEST_SUITE_P(Kinds, CreaseConstruction, ::testing::ValuesIn(testing::creased_domains()),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

TEST_P(CreaseConstruction, FunctionsSumToOne) {
  for (int degree = 1; degree <= 5; ++degree) {
    const auto net = placed(degree).net;
    const TriangularBSplineBasis<2> basis(net);
    for (const auto& x : all_points(net)) {
      EXPECT_NEAR(basis.evaluate(x).values.sum(), 1, 1e-10) << degree << " at " << x.transpose();
    }
  }
}

TEST_P(CreaseConstruction, PolynomialsAreReproducedByTheirPolarForms) {
  for (int degree = 1; degree <= 5; ++degree) {
    const auto net = placed(degree).net;
    const TriangularBSplineBasis<2> basis(net);
    for (int i = 0; i <= degree; ++i) {
      const std::array<int, 2> exponents = {i, degree - i};
      const auto c = basis.control_values([&](std::span<const Point<2>> arguments) {
        return monomial_polar_form<2>(exponents, arguments);
      });
      double largest = 0, error = 0;
      for (const auto& x : all_points(net)) {
        const auto b = basis.evaluate(x);
        const double truth = power(x[0], i) * power(x[1], degree - i);
        largest = std::max(largest, std::abs(truth));
        error = std::max(error, std::abs(c(b.control_points).dot(b.values) - truth));
      }
      EXPECT_LT(error, 1e-11 * largest) << "x^" << i << " y^" << degree - i;
    }
  }
}

TEST_P(CreaseConstruction, PolynomialsAreReproducedByFits) {
  for (int degree = 2; degree <= 3; ++degree) {
    const TriangularBSplineBasis<2> basis(placed(degree).net);
    for (int i = 0; i <= degree; i += 2) {
      const auto fit = project<2>(basis, [&](const Point<2>& x) {
        return Vector<2>(power(x[0], i) * power(x[1], degree - i),
                         power(x[1], i) * power(x[0], degree - i));
      });
      EXPECT_LT(fit.max_error, 1e-9 * power(testing::kHalfWidth, degree));
    }
  }
}

TEST_P(CreaseConstruction, IsContinuousAndSmoothOnAllOtherEdges) {
  for (int degree = 2; degree <= 3; ++degree) {
    const auto knots = placed(degree);
    const Jumps spline(knots.net, 6);
    EXPECT_LT(spline.largest_on_knot_lines()[0], 1e-11) << "degree " << degree;
    const auto collapsed = [&](int v) {  // asked for: edges at a sharp corner are hinges
      return knots.plan.vertices[v].rule == VertexRule::kCollapsed;
    };
    const auto other = spline.largest_on_edges([&](int a, int b) {
      return !testing::is_crease(knots.net, a, b) && !collapsed(a) && !collapsed(b);
    });
    EXPECT_LT(other[1], 1e-8) << "degree " << degree;
  }
}

// Integration cells fill their triangles; those in bands make the bands, outside the line's body.
TEST_P(CreaseConstruction, CellsFillTheirTriangles) {
  for (int degree = 2; degree <= 4; ++degree) {
    const auto knots = placed(degree);
    const auto& mesh = knots.net.mesh;
    std::vector<double> area(mesh.simplices.size(), 0);
    double in_bands = 0;
    for (const auto& e : TriangularBSplineBasis<2>(knots.net).quadrature(0, 0)) {
      area[e.patch] += e.weights.sum();
      if (e.in_band) in_bands += e.weights.sum();
    }
    for (std::size_t t = 0; t < area.size(); ++t) {
      const double whole = 0.5 * signed_content<2>(simplex_corners(mesh, static_cast<int>(t)));
      EXPECT_NEAR(area[t], whole, 1e-12 * whole) << "degree " << degree << ", triangle " << t;
    }
    EXPECT_NEAR(in_bands, knots.plan.band_area, 1e-12) << "degree " << degree;
    EXPECT_LT(knots.plan.band_area_in_bodies, 1e-12) << "degree " << degree;
  }
}

// Nothing but affine maps is free of bending energy, although the bands carry none.
TEST_P(CreaseConstruction, BendingHasTheAffineKernel) {
  for (int degree = 2; degree <= 3; ++degree) {
    const TriangularBSplineBasis<2> basis(placed(degree).net);
    const Eigen::MatrixXd K = BendingEnergy<2>(basis).matrix();
    const Eigen::VectorXd spectrum =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
    const double largest = spectrum[spectrum.size() - 1];
    EXPECT_EQ((spectrum.array() < 1e-12 * largest).count(), 3) << "degree " << degree;
    EXPECT_GT(spectrum[3], 1e-8 * largest) << "degree " << degree;
  }
}

// A line that goes straight on bends exactly along its edges and needs no band.
TEST(StraightCrease, IsExact) {
  for (const auto body : {BodySide::kNone, BodySide::kLeft}) {
    for (int degree = 2; degree <= 4; ++degree) {
      const auto placed =
          place_knots(testing::domain_with({testing::open_line({{-2.2, -0.7}, {2.2, 0.4}}, body)}),
                      {.degree = degree});
      const Vector<2> along = Vector<2>(4.4, 1.1).normalized();
      for (const auto& edge : placed.net.crease_edges) {
        for (int v : edge.vertices) {
          for (const auto& knot : placed.net.clouds[v]) {
            EXPECT_LT(std::abs(cross(along, Vector<2>(knot - Point<2>(-2.2, -0.7)))), 1e-12);
          }
        }
      }
      EXPECT_LT(placed.plan.band_area, 1e-12);
      const Jumps spline(placed.net, 6);
      const auto on_line = spline.largest_on_edges(
          [&](int a, int b) { return testing::is_crease(placed.net, a, b); });
      EXPECT_LT(on_line[0], 1e-11);
      EXPECT_GT(on_line[1], 1e-2);
      EXPECT_LT(spline.largest_on_edges(
                    [&](int a, int b) { return !testing::is_crease(placed.net, a, b); })[1],
                1e-9);
    }
  }
}

}  // namespace crease

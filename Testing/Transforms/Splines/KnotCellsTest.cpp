#include "Transforms/Splines/KnotCells.h"

#include <gtest/gtest.h>

#include <cmath>

#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Splines/KnotCellRule.h"
#include "Transforms/Splines/KnotLocator.h"

namespace crease {
namespace {

std::vector<KnotNet<2>> all_nets() {
  std::vector<KnotNet<2>> nets;
  for (int degree = 1; degree <= 5; ++degree) {
    nets.push_back(testing::jittered_net(3, 3, degree, 0.4, degree));
    nets.push_back(testing::straight_crease_net(degree, 0.4));
    nets.push_back(testing::ring_net(degree, 0.4, true));
    nets.push_back(testing::ring_net(degree, 0.4, false));
  }
  return nets;
}

TEST(KnotCells, FillTheirTriangle) {
  for (const auto& net : all_nets()) {
    const KnotCells cells(net);
    for (int t = 0; t < static_cast<int>(net.mesh.simplices.size()); ++t) {
      const double whole = 0.5 * signed_content<2>(simplex_corners(net.mesh, t));
      double sum = 0.0;
      for (const auto& cell : cells.of_triangle(t)) {
        EXPECT_GT(cell.area, 0.0);
        sum += cell.area;
      }
      EXPECT_NEAR(sum, whole, 1e-12 * whole);
    }
  }
}

// Mean numbers of cells of the theory: 1 / 15 / 71 / 197 / 441; the exact count depends on the pattern.
TEST(KnotCells, AreAsManyAsExpected) {
  const double expected[6] = {0, 1, 15, 71, 197, 441};
  for (int degree = 1; degree <= 5; ++degree) {
    const auto net = testing::jittered_net(4, 4, degree, 0.3, 1);
    const KnotCells cells(net);
    double count = 0.0;
    for (int t = 0; t < 32; ++t) count += static_cast<double>(cells.of_triangle(t).size());
    EXPECT_NEAR(count / 32.0 / expected[degree], 1.0, 0.35) << "degree " << degree;
    if (degree == 1) EXPECT_EQ(count, 32.0);
  }
}

// The bands' areas by clipping their hulls, independent of the cells.
TEST(KnotCells, KnowTheBandsOfCreases) {
  for (const bool body : {true, false}) {
    const auto net = testing::ring_net(3, 0.4, body);
    const KnotCells cells(net);
    const CreaseBands bands(net);
    double band = 0.0, two_sided = 0.0, inside_body = 0.0;
    for (int t = 0; t < static_cast<int>(net.mesh.simplices.size()); ++t) {
      double here = 0.0;
      for (const auto& cell : cells.of_triangle(t)) {
        if (!cell.in_band) continue;
        here += cell.area;
        if (cell.in_two_sided_band) two_sided += cell.area;
        if (net.mesh.region(t) == 1) inside_body += cell.area;
      }
      EXPECT_NEAR(here, bands.area_in(t), 1e-12);
      band += here;
    }
    EXPECT_GT(band, 0.05);
    EXPECT_LT(band, 1.0);  // of the 19.4 of the square
    EXPECT_NEAR(two_sided, body ? 0.0 : band, 1e-12);
    if (body) EXPECT_NEAR(inside_body, 0.0, 1e-12);
  }
  const auto straight = testing::straight_crease_net(3, 0.4);
  for (const auto& cell : KnotCells(straight).of_triangle(10)) EXPECT_FALSE(cell.in_band);
}

// Integral of x^i y^j over a triangle with corners (0,0), (1,0), (0,1): i! j! / (i + j + 2)!.
TEST(KnotCellRule, IsExactOnTriangles) {
  const std::vector<Point<2>> triangle = {{0, 0}, {1, 0}, {0, 1}};
  for (int degree = 0; degree <= 20; ++degree) {
    const CellRule rule = cell_rule(triangle, degree);
    for (int i = 0; i <= degree; ++i) {
      for (int j = 0; i + j <= degree; ++j) {
        double sum = 0.0;
        for (std::size_t k = 0; k < rule.points.size(); ++k) {
          sum += rule.weights[k] * std::pow(rule.points[k][0], i) * std::pow(rule.points[k][1], j);
        }
        const double truth =
            std::exp(std::lgamma(i + 1) + std::lgamma(j + 1) - std::lgamma(i + j + 3));
        EXPECT_NEAR(sum, truth, 1e-14) << "degree " << degree << ", x^" << i << " y^" << j;
      }
    }
  }
}

TEST(KnotCellRule, IsExactOnPolygonsAndStaysInside) {
  const KnotPolygon polygon = {{0, 0}, {3, -1}, {4.5, 0.5}, {4, 2}, {1, 2.5}};
  for (int degree = 0; degree <= 8; ++degree) {
    const CellRule rule = cell_rule(polygon, degree), finer = cell_rule(polygon, degree + 6);
    for (int i = 0; i <= degree; ++i) {
      double sum = 0.0, truth = 0.0;
      const auto f = [&](const Point<2>& p) {
        return std::pow(p[0], i) * std::pow(p[1], degree - i);
      };
      for (std::size_t k = 0; k < rule.points.size(); ++k)
        sum += rule.weights[k] * f(rule.points[k]);
      for (std::size_t k = 0; k < finer.points.size(); ++k)
        truth += finer.weights[k] * f(finer.points[k]);
      EXPECT_NEAR(sum, truth, 1e-13 * std::max(1.0, std::abs(truth)));
    }
    for (const auto& p : rule.points) EXPECT_TRUE(polygon_contains(polygon, p, 1e-12));
    for (double w : rule.weights) EXPECT_GT(w, 0.0);
  }
}

}  // namespace
}  // namespace crease

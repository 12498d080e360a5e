#include "Transforms/Domains/CreaseBands.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/ConvexPolygon.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/Mesher.h"

namespace crease {
namespace {

using testing::bent_line;
using testing::closed_line;

double total_area(const CreaseBands& bands, const SimplexMesh<2>& mesh) {
  double area = 0;
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t)
    area += bands.area_in(static_cast<int>(t));
  return area;
}

/// r(angle) = 10 + bump cos(3 angle): convex and concave by turns.
Polyline bean(double bump, int corners) {
  Polyline points;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.3) / corners;
    const double r = 10 + bump * std::cos(3 * angle);
    points.emplace_back(20 + r * std::cos(angle), 20 + r * std::sin(angle));
  }
  return points;
}

/// The disc of the prototype's figures: radius 1 in a square of half-width 2.2.
PlacedKnots disc(int corners) {
  const double edge = 2 * std::sin(std::numbers::pi / corners);
  return place_knots(mesh_domain(testing::rectangle(-2.2, -2.2, 2.2, 2.2),
                                 {closed_line(testing::regular_polygon({0, 0}, 1, corners))},
                                 {.edge_length = 0.5, .edge_length_near_lines = edge}));
}

}  // namespace

TEST(CreaseBands, StraightLinesHaveEmptyBands) {
  const auto placed = place_knots(bent_line(0));
  const CreaseBands bands(placed.net);
  ASSERT_EQ(bands.bands().size(), 4U);
  for (const auto& band : bands.bands()) EXPECT_TRUE(band.hull.empty());
  EXPECT_LT(total_area(bands, placed.net.mesh), 1e-12);
}

TEST(CreaseBands, HullsOfBothCloudsOnTheOuterSide) {
  const auto placed = place_knots(bent_line(0.2, BodySide::kRight));  // body below
  const CreaseBands bands(placed.net);
  int checked = 0;
  for (const auto& band : bands.bands()) {
    EXPECT_TRUE(band.body_side);
    Polyline knots = placed.net.clouds[band.vertices[0]];
    for (const auto& p : placed.net.clouds[band.vertices[1]]) knots.push_back(p);
    for (const auto& knot : knots) {
      const Point<2>& a = placed.net.mesh.vertices[band.vertices[0]];
      const Point<2>& b = placed.net.mesh.vertices[band.vertices[1]];
      EXPECT_GE(cross(b - a, knot - a), -1e-14);  // above the edge
    }
    if (band.hull.size() >= 3) {
      ++checked;
      EXPECT_NEAR(signed_area(band.hull), signed_area(convex_hull(knots)), 1e-15);
    }
  }
  EXPECT_EQ(checked, 4);
}

TEST(CreaseBands, BodyRuleKeepsBandsOutOfTheBody) {
  const std::vector<Polyline> outlines = {testing::regular_polygon({20, 20}, 10, 12),
                                          testing::regular_polygon({20, 20}, 10, 16), bean(1.5, 30),
                                          bean(3, 33)};
  for (const auto& outline : outlines) {
    for (const bool clockwise : {false, true}) {
      Polyline points = outline;
      if (clockwise) std::reverse(points.begin(), points.end());
      const auto domain = mesh_domain(testing::rectangle(0, 0, 40, 40), {closed_line(points)},
                                      {.edge_length = 8, .edge_length_near_lines = 3});
      for (int degree : {2, 3, 4}) {
        const auto placed = place_knots(domain, {.degree = degree});
        for (const auto& vertex : placed.plan.vertices) {  // small turns count as straight
          ASSERT_TRUE(vertex.rule != VertexRule::kStraight || vertex.turn_deg < 1e-9);
        }
        EXPECT_GT(placed.plan.band_area, 0);
        EXPECT_LT(placed.plan.band_area_in_bodies, 1e-12);
        for (const auto& edge : placed.net.crease_edges) EXPECT_TRUE(edge.body_side);
      }
    }
  }
}

TEST(CreaseBands, WithoutABodyBandsLieOnBothSides) {
  const auto domain =
      mesh_domain(testing::rectangle(0, 0, 40, 40),
                  {closed_line(testing::regular_polygon({20, 20}, 10, 16), BodySide::kNone)},
                  {.edge_length = 8, .edge_length_near_lines = 4});
  const auto placed = place_knots(domain);
  const CreaseBands bands(placed.net);
  EXPECT_GT(placed.plan.band_area, 0);
  EXPECT_EQ(placed.plan.band_area_in_bodies, 0);  // no band belongs to a body
  for (const auto& edge : placed.net.crease_edges) EXPECT_FALSE(edge.body_side);
  double inside = 0, outside = 0;
  for (std::size_t t = 0; t < placed.net.mesh.simplices.size(); ++t) {
    const auto& s = placed.net.mesh.simplices[t];
    const auto& p = placed.net.mesh.vertices;
    const bool in = ((p[s[0]] + p[s[1]] + p[s[2]]) / 3 - Point<2>(20, 20)).norm() < 10;
    (in ? inside : outside) += bands.area_in(static_cast<int>(t));
  }
  EXPECT_GT(inside, 0.1);
  EXPECT_GT(outside, 0.1);
}

TEST(CreaseBands, ShareOfTheDomainAsInThePrototype) {
  EXPECT_NEAR(disc(16).plan.band_share, 0.011, 0.003);
  EXPECT_NEAR(disc(24).plan.band_share, 0.005, 0.0015);
}

TEST(CreaseBands, ContainsAgreesWithAllHulls) {
  const auto placed = disc(12);
  const auto& mesh = placed.net.mesh;
  const CreaseBands bands(placed.net);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  int num_inside = 0;
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto& s = mesh.simplices[t];
    for (int i = 0; i < 20; ++i) {
      double a = uniform(generator), b = uniform(generator);
      if (a + b > 1) a = 1 - a, b = 1 - b;
      const Point<2> p = mesh.vertices[s[0]] + a * (mesh.vertices[s[1]] - mesh.vertices[s[0]]) +
                         b * (mesh.vertices[s[2]] - mesh.vertices[s[0]]);
      bool expected = false;
      for (const auto& band : bands.bands()) expected = expected || point_in_polygon(band.hull, p);
      EXPECT_EQ(bands.contains(static_cast<int>(t), p), expected);
      EXPECT_FALSE(bands.contains_two_sided(static_cast<int>(t), p));
      num_inside += expected;
    }
  }
  EXPECT_GT(num_inside, 20);
}

TEST(CreaseBands, UnionOfOverlappingBandsIsCountedOnce) {
  const auto placed = disc(12);
  const CreaseBands bands(placed.net);
  double sum = 0;
  for (const auto& band : bands.bands()) sum += signed_area(band.hull);
  double shared = 0;  // neighbours overlap in the hull of their common cloud
  for (std::size_t v = 0; v < placed.net.clouds.size(); ++v) {
    if (placed.plan.vertices[v].rule == VertexRule::kFanned) {
      shared += signed_area(convex_hull(placed.net.clouds[v]));
    }
  }
  const double area = total_area(bands, placed.net.mesh);
  EXPECT_LE(area, sum - shared + 1e-12);
  EXPECT_GT(area, 0.95 * (sum - shared));
}

}  // namespace crease

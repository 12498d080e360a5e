#include "Transforms/Domains/KnotPlacement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <sstream>

#include "Core/Error.h"
#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/KnotNetCheck.h"
#include "Transforms/Domains/KnotTriangles.h"
#include "Transforms/Domains/Mesher.h"

namespace crease {
namespace {

using testing::bent_line;
using testing::box;
using testing::closed_line;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::kUnitInradius;
using testing::open_line;
using testing::square;
using ::testing::ThrowsMessage;
using testing::vertex_at;

/// Every triangle of knots near lines keeps a twentieth of its mesh triangle.
void expect_checked(const KnotNet<2>& net) {
  EXPECT_NO_THROW(validate(net));
  for (const auto& s : net.mesh.simplices) {
    EXPECT_GE(
        smallest_knot_triangle({net.clouds[s[0]], net.clouds[s[1]], net.clouds[s[2]]}, net.degree),
        0.05);
  }
}

}  // namespace

TEST(KnotPlacement, DegreesOneToFiveAreValid) {
  const auto domain = mesh_domain(testing::rectangle(0, 0, 40, 40),
                                  {closed_line(testing::regular_polygon({20, 20}, 9, 14))},
                                  {.edge_length = 8, .edge_length_near_lines = 4});
  for (int degree = 1; degree <= 5; ++degree) {
    const auto placed = place_knots(domain, {.degree = degree});
    EXPECT_NO_THROW(validate(placed.net));
    EXPECT_EQ(placed.net.clouds[0].size(), static_cast<std::size_t>(std::max(1, degree)));
  }
}

TEST(KnotPlacement, ReversingALineWithItsBodySideChangesNothing) {
  for (const auto body : {BodySide::kLeft, BodySide::kRight, BodySide::kNone}) {
    const auto forward = bent_line(0.25, body);
    Polyline points;
    for (int v : forward.chains[0].vertices) points.push_back(forward.mesh.vertices[v]);
    SimplexMesh<2> mesh = forward.mesh;
    const auto backward =
        attach_feature_lines(mesh, {reversed(open_line(points, forward.chains[0].body))});
    const auto a = place_knots(forward).net, b = place_knots(backward).net;
    for (std::size_t v = 0; v < a.clouds.size(); ++v) {
      for (int k = 0; k < 3; ++k) EXPECT_LT((a.clouds[v][k] - b.clouds[v][k]).norm(), 1e-12);
    }
  }
}

TEST(KnotPlacement, RenumberingVerticesChangesNothing) {
  const auto domain = bent_line(0.25, BodySide::kLeft);
  const int n = static_cast<int>(domain.mesh.vertices.size());
  ASSERT_GT(n, 0);
  const auto other = [&](int v) { return (7 * v + 3) % n; };  // 7 and 15 have no common divisor
  DomainMesh renumbered = domain;
  for (int v = 0; v < n; ++v) renumbered.mesh.vertices[other(v)] = domain.mesh.vertices[v];
  for (auto& s : renumbered.mesh.simplices) {
    for (int& v : s) v = other(v);
  }
  std::reverse(renumbered.mesh.simplices.begin(), renumbered.mesh.simplices.end());
  for (int& v : renumbered.chains[0].vertices) v = other(v);
  const auto a = place_knots(domain).net, b = place_knots(renumbered).net;
  for (int v = 0; v < n; ++v) {
    for (int k = 0; k < 3; ++k) EXPECT_LT((a.clouds[v][k] - b.clouds[other(v)][k]).norm(), 1e-9);
  }
}

TEST(KnotPlacement, CongruentCloudsOnStructuredMeshes) {
  for (const auto diagonals : {Diagonals::kUnionJack, Diagonals::kRising, Diagonals::kFalling}) {
    const auto placed = place_knots(square(6, {}, diagonals), {.structured = true});
    EXPECT_NO_THROW(validate(placed.net));
    const auto& reference = placed.net.clouds[vertex_at(placed.net.mesh, {2, 2})];
    for (std::size_t v = 0; v < placed.net.clouds.size(); ++v) {
      if (placed.plan.vertices[v].rule != VertexRule::kInner) continue;
      for (int k = 1; k < 3; ++k) {
        const Vector<2> offset = placed.net.clouds[v][k] - placed.net.clouds[v][0];
        EXPECT_LT((offset - (reference[k] - reference[0])).norm(), 1e-12);
      }
    }
    const auto& below = placed.net.clouds[vertex_at(placed.net.mesh, {2, 0})];
    const auto& next = placed.net.clouds[vertex_at(placed.net.mesh, {4, 0})];
    EXPECT_LT((below[1] - below[0] - next[1] + next[0]).norm(), 1e-12);
  }
}

TEST(KnotPlacement, NoThreeKnotsOfATriangleAreAlmostOnALine) {
  const auto placed =
      place_knots(square(6, {}, Diagonals::kRising), {.degree = 4, .structured = true});
  const auto& net = placed.net;
  for (const auto& s : net.mesh.simplices) {
    std::vector<Point<2>> knots;
    for (int v : s) knots.insert(knots.end(), net.clouds[v].begin(), net.clouds[v].end());
    for (std::size_t i = 0; i < knots.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        for (std::size_t k = 0; k < j; ++k) {
          const bool inner = i % 4 > 0 && placed.plan.vertices[s[i / 4]].rule == VertexRule::kInner;
          if (!inner) continue;
          const double area = std::abs(cross(knots[j] - knots[i], knots[k] - knots[i]));
          const double longest =
              std::max({(knots[j] - knots[i]).norm(), (knots[k] - knots[i]).norm(),
                        (knots[k] - knots[j]).norm()});
          EXPECT_GT(area / longest, 0.99e-3 * 0.5 * kUnitInradius);
        }
      }
    }
  }
}

TEST(KnotPlacement, ExperimentOneDiamond) {
  const auto domain = square(6, {closed_line({{5, 3}, {3, 5}, {1, 3}, {3, 1}})});
  const auto placed = place_knots(domain, {.structured = true});
  expect_checked(placed.net);
  EXPECT_EQ(placed.plan.count(VertexRule::kCorner), 4);
  EXPECT_EQ(placed.plan.count(VertexRule::kStraight), 4);
  EXPECT_EQ(placed.plan.num_crease_edges, 8);
  EXPECT_LT(placed.plan.band_area_in_bodies, 1e-12);
  for (const auto& edge : placed.net.crease_edges) EXPECT_TRUE(edge.body_side);
}

TEST(KnotPlacement, WithoutCreasesLinesAreOrdinaryEdges) {
  const auto domain = square(6, {closed_line({{5, 3}, {3, 5}, {1, 3}, {3, 1}})});
  const auto without = place_knots(domain, {.creases = false});
  EXPECT_TRUE(without.net.crease_edges.empty());
  EXPECT_EQ(without.plan.count(VertexRule::kInner), 25);
  EXPECT_EQ(without.plan.band_area, 0);
}

TEST(KnotPlacement, RadiiAreHalvedUntilTheTrianglesAreValid) {
  SimplexMesh<2> mesh = structured_triangulation(box(0, 0, 4, 4), 4, 4, Diagonals::kRising);
  mesh.vertices[12] = {2, 2.3};   // bends the line
  mesh.vertices[17] = {2, 2.42};  // a neighbour close above it
  const auto domain = attach_feature_lines(
      mesh, {open_line({{0, 2}, {1, 2}, {2, 2.3}, {3, 2}, {4, 2}}, BodySide::kRight)});
  const auto placed = place_knots(domain);
  EXPECT_GT(placed.plan.num_halved, 0);
  EXPECT_LE(placed.plan.vertices[12].halvings, 4);
  EXPECT_NEAR(placed.plan.vertices[12].radius,
              0.25 * std::hypot(1, 0.3) / std::pow(2, placed.plan.vertices[12].halvings), 1e-12);
  EXPECT_NO_THROW(validate(placed.net));
}

TEST(KnotPlacement, HopelessVerticesAreCollapsedWithAWarning) {
  SimplexMesh<2> mesh = structured_triangulation(box(0, 0, 4, 4), 4, 4, Diagonals::kRising);
  mesh.vertices[12] = {2, 2.3};
  mesh.vertices[17] = {2, 2.301};
  const auto domain = attach_feature_lines(
      mesh, {open_line({{0, 2}, {1, 2}, {2, 2.3}, {3, 2}, {4, 2}}, BodySide::kRight)});
  const auto placed = place_knots(domain);
  EXPECT_EQ(placed.plan.vertices[12].rule, VertexRule::kCollapsed);
  EXPECT_THAT(placed.plan.warnings, Contains(HasSubstr("(2, 2.3) mm were collapsed")));
  EXPECT_NO_THROW(validate(placed.net));
}

TEST(KnotPlacement, BorderCloudsShrinkInNarrowNotches) {
  // A slot of width 0.1 cut into a square.
  const RegionOfInterest region(
      {{{0, 0}, {10, 0}, {10, 10}, {5.05, 10}, {5.05, 4}, {4.95, 4}, {4.95, 10}, {0, 10}}});
  const auto domain = mesh_domain(region, {}, {.edge_length = 2});
  const auto placed = place_knots(domain);
  EXPECT_NO_THROW(validate(placed.net));
}

TEST(KnotPlacement, WideBandsAreWarnedOf) {
  const auto domain = mesh_domain(testing::rectangle(0, 0, 24, 24),
                                  {closed_line(testing::regular_polygon({12, 12}, 10, 6))},
                                  {.edge_length = 10, .edge_length_near_lines = 10});
  const auto placed = place_knots(domain, {.fan_body = 0.4, .fan_corner = 0.4});
  EXPECT_GT(placed.plan.band_share, 0.05);
  EXPECT_THAT(placed.plan.warnings, Contains(HasSubstr("too coarse for their curvature")));
}

TEST(KnotPlacement, ThePlanIsPrinted) {
  std::ostringstream stream;
  stream << place_knots(bent_line(0.2, BodySide::kLeft)).plan;
  EXPECT_THAT(stream.str(), HasSubstr("fanned 3"));
  EXPECT_THAT(stream.str(), HasSubstr("border meeting 2"));
  EXPECT_THAT(stream.str(), HasSubstr("crease edges: 4"));
}

TEST(KnotPlacement, BadOptionsAreNamed) {
  const auto domain = bent_line(0);
  const auto expect = [&](const KnotOptions& options, const std::string& part) {
    EXPECT_THAT([&] { place_knots(domain, options); },
                ThrowsMessage<InvalidInput>(HasSubstr(part)));
  };
  expect({.degree = 0}, "degree = 0");
  expect({.degree = 6}, "degree = 6");
  expect({.degree = 3, .smoothness = 3}, "smoothness = 3");
  expect({.alpha = 1}, "alpha = 1");
  expect({.fan_body = 0.45}, "fan_body = 0.45");
  DomainMesh folded = domain;
  std::swap(folded.mesh.simplices[2][0], folded.mesh.simplices[2][1]);
  EXPECT_THAT([&] { place_knots(folded); }, ThrowsMessage<InvalidInput>(HasSubstr("triangle 2")));
}

}  // namespace crease

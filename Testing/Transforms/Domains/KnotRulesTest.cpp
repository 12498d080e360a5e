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
#include "Transforms/Domains/KnotPlacement.h"
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

constexpr int kMiddle = 7;  // of bent_line
constexpr double kExact = 1e-14;

void expect_knots(const PlacedKnots& placed, int vertex, const std::vector<Vector<2>>& offsets) {
  const auto& cloud = placed.net.clouds[vertex];
  ASSERT_EQ(cloud.size(), offsets.size() + 1);
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    EXPECT_LT((cloud[k + 1] - cloud[0] - offsets[k]).norm(), kExact)
        << "knot " << k + 1 << " of vertex " << vertex << ": "
        << (cloud[k + 1] - cloud[0]).transpose();
  }
}

}  // namespace

TEST(KnotRules, InnerCloudsLieOnACircleOfHalfTheInradius) {
  const auto placed = place_knots(square(4, {}));
  const int v = vertex_at(placed.net.mesh, {2, 1});
  EXPECT_EQ(placed.plan.vertices[v].rule, VertexRule::kInner);
  const auto& cloud = placed.net.clouds[v];
  ASSERT_EQ(cloud.size(), 3U);
  for (int k = 1; k < 3; ++k)
    EXPECT_NEAR((cloud[k] - cloud[0]).norm(), 0.5 * kUnitInradius, kExact);
  EXPECT_NEAR(std::abs(turn_angle(cloud[1] - cloud[0], cloud[2] - cloud[0])), 2.39996, 1e-12);
}

TEST(KnotRules, StraightLinesCarryTheirKnotsExactly) {
  const auto none = place_knots(bent_line(0));
  expect_knots(none, kMiddle, {{0.35, 0}, {-0.35, 0}});
  EXPECT_EQ(none.plan.vertices[kMiddle].rule, VertexRule::kStraight);
  const auto body = place_knots(bent_line(0, BodySide::kLeft));
  expect_knots(body, kMiddle, {{0.25, 0}, {-0.25, 0}});
  const auto quintic = place_knots(bent_line(0, BodySide::kLeft), {.degree = 5});
  expect_knots(quintic, kMiddle, {{0.25, 0}, {-0.25, 0}, {0.125, 0}, {-0.0625, 0}});
}

TEST(KnotRules, TurnsBelowADegreeCountAsStraight) {
  const double height = std::tan(0.49 * std::numbers::pi / 360);
  const auto placed = place_knots(bent_line(height, BodySide::kLeft));
  EXPECT_EQ(placed.plan.vertices[kMiddle].rule, VertexRule::kStraight);
  EXPECT_NEAR(placed.net.clouds[kMiddle][1].y(), placed.net.clouds[kMiddle][0].y(), kExact);
  EXPECT_NEAR(placed.plan.vertices[kMiddle].turn_deg, 0.49, 1e-9);
}

TEST(KnotRules, ConvexFanProlongsBothEdgesAwayFromTheBody) {
  // The body lies below the line, which rises to the middle: convex there.
  const auto placed = place_knots(bent_line(0.2, BodySide::kRight));
  EXPECT_EQ(placed.plan.vertices[kMiddle].rule, VertexRule::kFanned);
  expect_knots(placed, kMiddle, {0.25 * Vector<2>(-1, 0.2), 0.25 * Vector<2>(1, 0.2)});
  EXPECT_NEAR(placed.plan.vertices[kMiddle].radius, 0.25 * std::hypot(1, 0.2), kExact);
  EXPECT_NEAR(placed.plan.largest_chord_offset, std::hypot(1, 0.2) * 2 * std::atan(0.2) / 8, 1e-12);
}

TEST(KnotRules, ConcaveFanStaysOnTheEdges) {
  const auto placed = place_knots(bent_line(0.2, BodySide::kLeft));
  EXPECT_EQ(placed.plan.vertices[kMiddle].rule, VertexRule::kFanned);
  expect_knots(placed, kMiddle, {0.25 * Vector<2>(1, -0.2), 0.25 * Vector<2>(-1, -0.2)});
}

TEST(KnotRules, WithoutABodyTheTangentCarriesTheKnots) {
  const auto placed = place_knots(bent_line(0.2));
  EXPECT_EQ(placed.plan.vertices[kMiddle].rule, VertexRule::kTangent);
  const double r = 0.35 * std::hypot(1, 0.2);
  expect_knots(placed, kMiddle, {{r, 0}, {-r, 0}});
}

TEST(KnotRules, CornersAreBluntWithASmallerFanOrCollapsed) {
  FeatureLine line = open_line({{1, 2}, {2, 2}, {2, 1}}, BodySide::kRight);
  const auto blunt = place_knots(square(4, {line}, Diagonals::kFalling));
  const int v = vertex_at(blunt.net.mesh, {2, 2});
  EXPECT_EQ(blunt.plan.vertices[v].rule, VertexRule::kCorner);
  EXPECT_NEAR(blunt.plan.largest_turn_deg, 90, 1e-10);
  // Body below and left of the corner: both edges prolonged, to the right and upwards.
  const auto& cloud = blunt.net.clouds[v];
  const double r = blunt.plan.vertices[v].radius;
  EXPECT_EQ(blunt.plan.vertices[v].halvings, 0);
  EXPECT_NEAR(r, 0.2, kExact);
  EXPECT_LT((cloud[1] - Point<2>(2, 2 + r)).norm(), kExact);
  EXPECT_LT((cloud[2] - Point<2>(2 + r, 2)).norm(), kExact);
  line.corner = CornerRule::kCollapse;
  const auto sharp = place_knots(square(4, {line}, Diagonals::kFalling));
  EXPECT_EQ(sharp.plan.vertices[v].rule, VertexRule::kCollapsed);
  expect_knots(sharp, v, {{0, 0}, {0, 0}});
}

TEST(KnotRules, JunctionsAndEndsAreGeneric) {
  const auto placed = place_knots(
      square(4, {open_line({{1, 2}, {3, 2}}), open_line({{2, 1}, {2, 3}})}, Diagonals::kRising));
  const int junction = vertex_at(placed.net.mesh, {2, 2}), end = vertex_at(placed.net.mesh, {1, 2});
  EXPECT_EQ(placed.plan.vertices[junction].rule, VertexRule::kJunction);
  EXPECT_NEAR(placed.plan.vertices[junction].radius, 0.5 * kUnitInradius, kExact);
  EXPECT_EQ(placed.plan.vertices[end].rule, VertexRule::kLineEnd);
  EXPECT_EQ(placed.plan.count(VertexRule::kLineEnd), 4);
  EXPECT_EQ(placed.plan.num_crease_edges, 4);
  EXPECT_NEAR(std::abs(turn_angle(placed.net.clouds[end][1] - placed.net.clouds[end][0],
                                  placed.net.clouds[end][2] - placed.net.clouds[end][0])),
              2.39996, 1e-12);
}

TEST(KnotRules, JunctionRadiusDoesNotFollowAlpha) {
  const auto placed = place_knots(
      square(4, {open_line({{1, 2}, {3, 2}}), open_line({{2, 1}, {2, 3}})}, Diagonals::kRising),
      {.alpha = 0.2});
  const int junction = vertex_at(placed.net.mesh, {2, 2});
  EXPECT_NEAR(placed.plan.vertices[junction].radius, 0.5 * kUnitInradius, kExact);
}

TEST(KnotRules, LinesThatMeetTheBorderAreProlongedOutside) {
  const auto placed = place_knots(bent_line(0, BodySide::kLeft));
  const double r = 0.5 * kUnitInradius;
  EXPECT_EQ(placed.plan.vertices[5].rule, VertexRule::kBorderMeeting);
  expect_knots(placed, 5, {{-r, 0}, {-0.75 * r, 0}});
  expect_knots(placed, 9, {{r, 0}, {0.75 * r, 0}});
}

TEST(KnotRules, BorderKnotsLieInTheOuterWedge) {
  // An L: convex corners, one re-entrant corner, straight stretches.
  const RegionOfInterest region({{{0, 0}, {6, 0}, {6, 3}, {3, 3}, {3, 6}, {0, 6}}});
  const auto domain = mesh_domain(region, {}, {.edge_length = 1.5});
  for (int degree : {2, 3, 5}) {
    const auto placed = place_knots(domain, {.degree = degree});
    EXPECT_NO_THROW(validate(placed.net));
    for (std::size_t v = 0; v < placed.net.clouds.size(); ++v) {
      if (placed.plan.vertices[v].rule != VertexRule::kBorder) continue;
      EXPECT_EQ(placed.plan.vertices[v].halvings, 0);
      for (std::size_t k = 1; k < placed.net.clouds[v].size(); ++k) {
        EXPECT_FALSE(region.contains(placed.net.clouds[v][k]));
        EXPECT_NEAR((placed.net.clouds[v][k] - placed.net.clouds[v][0]).norm(),
                    placed.plan.vertices[v].radius, 1e-12);
      }
    }
  }
}

TEST(KnotRules, KnotsOnAStraightBorder) {
  const auto placed = place_knots(square(4, {}), {.border = BorderRule::kOnStraightBorder});
  const double r = 0.5 * kUnitInradius;
  const int v = vertex_at(placed.net.mesh, {2, 0});
  EXPECT_LT(std::abs(placed.net.clouds[v][1].y()), kExact);
  EXPECT_NEAR(std::abs(placed.net.clouds[v][1].x() - 2), r, kExact);
  EXPECT_NEAR(placed.net.clouds[v][1].x() + placed.net.clouds[v][2].x(), 4, kExact);
  expect_knots(placed, 0, {{0, 0}, {0, 0}});
  EXPECT_EQ(placed.plan.vertices[0].rule, VertexRule::kCollapsed);
  EXPECT_NO_THROW(validate(placed.net));
}

TEST(KnotRules, CollapsedBorder) {
  const auto placed = place_knots(square(4, {}), {.border = BorderRule::kCollapsed});
  expect_knots(placed, vertex_at(placed.net.mesh, {2, 0}), {{0, 0}, {0, 0}});
  EXPECT_EQ(placed.plan.count(VertexRule::kCollapsed), 16);
  EXPECT_NO_THROW(validate(placed.net));
}

TEST(KnotRules, LessSmoothnessRepeatsTheLastDistinctKnot) {
  const auto domain = bent_line(0.2, BodySide::kLeft);
  const auto cubic = place_knots(domain, {.degree = 3, .smoothness = 1});
  for (const auto& cloud : cubic.net.clouds) EXPECT_EQ(cloud[1], cloud[2]);
  const auto quartic = place_knots(domain, {.degree = 4, .smoothness = 2});
  for (const auto& cloud : quartic.net.clouds) {
    EXPECT_EQ(cloud[2], cloud[3]);
    EXPECT_NE(cloud[1], cloud[2]);
  }
  const auto lagrange = place_knots(domain, {.degree = 3, .smoothness = 0});
  for (const auto& cloud : lagrange.net.clouds) EXPECT_EQ(cloud[2], cloud[0]);
  for (const auto* placed : {&cubic, &quartic, &lagrange}) EXPECT_NO_THROW(validate(placed->net));
}

TEST(KnotRules, VerticesInsideBodiesMayCollapse) {
  const auto domain = square(6, {closed_line({{5, 3}, {3, 5}, {1, 3}, {3, 1}})});
  const auto placed = place_knots(domain, {.collapse_inside_bodies = true});
  EXPECT_EQ(placed.plan.count(VertexRule::kInsideBody), 5);  // (3,3) and its four neighbours
  expect_knots(placed, vertex_at(placed.net.mesh, {3, 3}), {{0, 0}, {0, 0}});
  EXPECT_EQ(place_knots(domain).plan.count(VertexRule::kInsideBody), 0);
  EXPECT_NO_THROW(validate(placed.net));
}

TEST(KnotRules, TangentsTurnAwayFromMeshEdges) {
  SimplexMesh<2> mesh = structured_triangulation(box(0, 0, 4, 2), 4, 2, Diagonals::kRising);
  mesh.vertices[kMiddle] = {2, 1.4};
  mesh.vertices[13] = {3, 1.4};  // a mesh edge along the tangent
  const auto domain =
      attach_feature_lines(mesh, {open_line({{0, 1}, {1, 1}, {2, 1.4}, {3, 1}, {4, 1}})});
  const auto placed = place_knots(domain);
  const Vector<2> direction = placed.net.clouds[kMiddle][1] - placed.net.clouds[kMiddle][0];
  EXPECT_NEAR(std::abs(turn_angle({1, 0}, direction)) * 180 / std::numbers::pi, 2, 1e-9);
  EXPECT_LT((placed.net.clouds[kMiddle][2] - placed.net.clouds[kMiddle][0] + direction).norm(),
            kExact);
}

}  // namespace crease

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/KnotNetCheck.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/Mesher.h"

namespace crease {
namespace {

using testing::closed_line;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::open_line;
using testing::rectangle;
using ::testing::ThrowsMessage;

const MeshOptions kOptions{.edge_length = 20, .edge_length_near_lines = 8};

bool has_vertex(const DomainMesh& domain, const Point<2>& p, double tolerance = 1e-9) {
  return std::any_of(domain.mesh.vertices.begin(), domain.mesh.vertices.end(),
                     [&](const Point<2>& v) { return (v - p).norm() <= tolerance; });
}

int count(const DomainMesh& domain, VertexRule rule) {
  const auto placed = place_knots(domain);
  EXPECT_NO_THROW(validate(placed.net));
  return placed.plan.count(rule);
}

double chain_length(const DomainMesh& domain) {
  double length = 0;
  for (const auto& chain : domain.chains) {
    Polyline points;
    for (int v : chain.vertices) points.push_back(domain.mesh.vertices[v]);
    length += polyline_length(points, chain.closed);
  }
  return length;
}

}  // namespace

TEST(LineArrangement, CrossingsBecomeJunctions) {
  const auto domain =
      mesh_domain(rectangle(0, 0, 100, 100),
                  {open_line({{20, 50}, {80, 50}}), open_line({{45, 20}, {55, 80}})}, kOptions);
  EXPECT_TRUE(has_vertex(domain, {50, 50}, 2.1));
  EXPECT_EQ(count(domain, VertexRule::kJunction), 1);
  EXPECT_EQ(count(domain, VertexRule::kLineEnd), 4);
}

TEST(LineArrangement, LineThatCrossesItselfGetsAJunction) {
  const auto domain = mesh_domain(rectangle(0, 0, 100, 100),
                                  {open_line({{20, 30}, {80, 70}, {80, 30}, {20, 70}})}, kOptions);
  EXPECT_TRUE(has_vertex(domain, {50, 50}, 2.1));
  EXPECT_EQ(count(domain, VertexRule::kJunction), 1);
}

TEST(LineArrangement, LinesAreClippedWithAWarning) {
  const auto domain =
      mesh_domain(rectangle(0, 0, 100, 100), {open_line({{-50, 40}, {150, 40}})}, kOptions);
  EXPECT_THAT(domain.warnings, Contains(HasSubstr("50 % of it is outside")));
  EXPECT_NEAR(chain_length(domain), 100, 1e-9);
  EXPECT_TRUE(has_vertex(domain, {0, 40}));
  EXPECT_EQ(count(domain, VertexRule::kBorderMeeting), 2);
}

TEST(LineArrangement, LinesOutsideAreRefused) {
  FeatureLine line = open_line({{200, 40}, {250, 40}});
  line.name = "far";
  EXPECT_THAT([&] { mesh_domain(rectangle(0, 0, 100, 100), {line}, kOptions); },
              ThrowsMessage<InvalidInput>(
                  ::testing::AllOf(HasSubstr("feature line far"), HasSubstr("wholly outside"))));
}

TEST(LineArrangement, ClosedLineOverTheBorderBecomesOpenAndKeepsItsRegion) {
  const FeatureLine body = closed_line(testing::regular_polygon({0, 50}, 25, 24));
  const auto domain = mesh_domain(rectangle(0, 0, 100, 100), {body}, kOptions);
  ASSERT_EQ(domain.chains.size(), 1U);
  EXPECT_FALSE(domain.chains[0].closed);
  EXPECT_EQ(domain.chains[0].body, BodySide::kLeft);
  double inside = 0;  // the part of the polygon with x > 0, by its trapezoids
  for (std::size_t i = 0; i < body.points.size(); ++i) {
    const Point<2> a = body.points[i].cwiseMax(Point<2>(0, -1e9));
    const Point<2> b = body.points[(i + 1) % body.points.size()].cwiseMax(Point<2>(0, -1e9));
    inside += 0.5 * (a.x() + b.x()) * (b.y() - a.y());
  }
  EXPECT_NEAR(testing::region_area(domain.mesh, 1), inside, 0.02 * inside);
  EXPECT_EQ(count(domain, VertexRule::kBorderMeeting), 2);
}

TEST(LineArrangement, EndsThatAlmostReachTheBorderOrALineAreJoined) {
  const auto domain = mesh_domain(
      rectangle(0, 0, 100, 100),
      {open_line({{1.2, 50}, {60, 50}}), open_line({{60.9, 20}, {60.9, 80}})}, kOptions);
  EXPECT_THAT(domain.notes, Contains(HasSubstr("merged with it")));
  EXPECT_EQ(count(domain, VertexRule::kBorderMeeting), 1);
  EXPECT_EQ(count(domain, VertexRule::kJunction), 1);
  EXPECT_EQ(count(domain, VertexRule::kLineEnd), 2);
}

TEST(LineArrangement, PointsNearerThanAQuarterEdgeAreMerged) {
  const auto domain = mesh_domain(
      rectangle(0, 0, 100, 100),
      {open_line({{20, 50}, {28, 50}, {28.5, 50.1}, {36, 50}, {44, 50}, {44, 50}})}, kOptions);
  EXPECT_THAT(domain.notes, Contains(HasSubstr("were merged")));
  EXPECT_GT(mesh_figures(domain.mesh).smallest_edge, 2);
}

TEST(LineArrangement, NeighboursThatShareAStretchHaveNoBodySideThere) {
  const auto domain = mesh_domain(rectangle(0, 0, 100, 100),
                                  {closed_line({{20, 20}, {50, 20}, {50, 70}, {20, 70}}),
                                   closed_line({{50, 30}, {80, 30}, {80, 80}, {50, 80}})},
                                  kOptions);
  EXPECT_NEAR(testing::region_area(domain.mesh, 1), 1500, 1e-9);
  EXPECT_NEAR(testing::region_area(domain.mesh, 2), 1500, 1e-9);
  double without_side = 0;
  for (const auto& chain : domain.chains) {
    if (chain.body != BodySide::kNone) continue;
    Polyline points;
    for (int v : chain.vertices) points.push_back(domain.mesh.vertices[v]);
    without_side += polyline_length(points, false);
  }
  EXPECT_NEAR(without_side, 40, 1e-9);
  EXPECT_NEAR(chain_length(domain), 160 + 160 - 40, 1e-9);  // the shared stretch once
  EXPECT_EQ(count(domain, VertexRule::kJunction), 2);
}

TEST(LineArrangement, LinesAlongTheBorderAreLeftOut) {
  const auto domain = mesh_domain(rectangle(0, 0, 100, 100),
                                  {open_line({{30, 40}, {30, 0}, {70, 0}, {70, 40}})}, kOptions);
  EXPECT_NEAR(chain_length(domain), 80, 1e-9);
  EXPECT_EQ(count(domain, VertexRule::kBorderMeeting), 2);
}

TEST(LineArrangement, PixelStairsAreWarnedOf) {
  Polyline stairs;
  for (int i = 0; i < 20; ++i) {
    stairs.emplace_back(20 + i, 20 + i);
    stairs.emplace_back(21 + i, 20 + i);
  }
  const auto domain = mesh_domain(rectangle(0, 0, 100, 100), {open_line(stairs)}, kOptions);
  EXPECT_THAT(domain.warnings, Contains(HasSubstr("pixel stairs")));
}

TEST(LineArrangement, SharpMeetingsAreReported) {
  const auto domain =
      mesh_domain(rectangle(0, 0, 100, 100), {open_line({{10, 50}, {90, 62}, {10, 66}})}, kOptions);
  EXPECT_THAT(domain.notes, Contains(HasSubstr("angle below 20 degrees")));
  EXPECT_NO_THROW(validate(place_knots(domain).net));
}

TEST(LineArrangement, TouchingLabelOutlinesMeetInJunctions) {
  FeatureLine a = open_line({{50, 80}, {20, 50}, {50, 20}}, BodySide::kLeft);
  FeatureLine b = open_line({{50, 20}, {80, 50}, {50, 80}}, BodySide::kLeft);
  FeatureLine shared = open_line({{50, 20}, {50, 80}});
  a.left_label = shared.left_label = 1;
  b.left_label = shared.right_label = 2;
  const auto domain = mesh_domain(rectangle(0, 0, 100, 100), {a, b, shared}, kOptions);
  EXPECT_NEAR(testing::region_area(domain.mesh, 1), 900, 1e-9);
  EXPECT_NEAR(testing::region_area(domain.mesh, 2), 900, 1e-9);
  EXPECT_EQ(count(domain, VertexRule::kJunction), 2);
}

TEST(LineArrangement, ManyRandomLinesAreDisentangled) {
  for (int seed = 0; seed < 40; ++seed) {
    unsigned state = 977U * static_cast<unsigned>(seed) + 5;
    const auto uniform = [&] {
      state = state * 1664525U + 1013904223U;
      return static_cast<double>(state >> 8) / (1 << 24);
    };
    std::vector<FeatureLine> lines;
    for (int l = 0; l < 5; ++l) {
      Polyline points;
      for (int i = 0; i < 3 + l % 3; ++i) points.emplace_back(100 * uniform(), 100 * uniform());
      lines.push_back(l % 2 == 0 ? open_line(points) : closed_line(points));
    }
    const auto domain = mesh_domain(rectangle(0, 0, 100, 100), lines, kOptions);
    EXPECT_NEAR(mesh_figures(domain.mesh).area, 10000, 1e-7) << seed;
    EXPECT_NO_THROW(validate(place_knots(domain).net)) << seed;
  }
}

}  // namespace crease

#include "Registration/Elastic/BodyOutline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "Core/Error.h"
#include "Transforms/Domains/Mesher.h"
#include "Transforms/Splines/KnotLocator.h"

namespace crease {

TEST(ChestWallEnds, AreTheEndsOfTheStraightSide) {
  for (double side : {1.0, -1.0}) {
    Polyline outline;
    constexpr int kPoints = 60;
    for (int i = 0; i <= kPoints; ++i) {  // half an ellipse
      const double t = (static_cast<double>(i) / kPoints - 0.5) * std::numbers::pi;
      outline.push_back({side * 70 * std::cos(t), 95 * std::sin(t)});
    }
    const auto ends = chest_wall_ends(RegionOfInterest({outline}));
    EXPECT_LT((ends[0] - Point<2>(0, -95)).norm(), 1e-9);
    EXPECT_LT((ends[1] - Point<2>(0, 95)).norm(), 1e-9);
  }
}

// A notch of 3 mm stays, chips of no more than 1 mm go; what is left beside one has long edges.
TEST(WithoutShortEdges, LeavesOutCornersThatSayLittle) {
  const Polyline ring = {{0, 0},      {50, 0},   {50.5, 1}, {51, 0},   {100, 0}, {100, 99.5},
                         {99.5, 100}, {60, 100}, {59, 97},  {58, 100}, {0, 100}};
  const Polyline expected = {{0, 0},    {51, 0},  {100, 0},  {100, 99.5},
                             {60, 100}, {59, 97}, {58, 100}, {0, 100}};
  EXPECT_EQ(without_short_edges(ring, 4, 1), expected);
  EXPECT_EQ(without_short_edges(ring, 0.5, 1), ring);
  EXPECT_EQ(without_short_edges({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 5, 9).size(), 4);
}

// Each corner of an arc is near to the chord of its neighbours; what is left must be near to all.
TEST(WithoutShortEdges, DoesNotAddUp) {
  Polyline ring = {{0, 0}};
  for (int k = 0; k <= 200; ++k) {
    const double t = k * std::numbers::pi / 200;
    ring.emplace_back(50 - 50 * std::cos(t), 20 + 50 * std::sin(t));
  }
  ring.emplace_back(100, 0);
  const Polyline found = without_short_edges(ring, 1e3, 0.5);
  EXPECT_LT(found.size(), 30);
  for (const Point<2>& p : ring) EXPECT_LE(distance_to_polyline(found, true, p), 0.5 + 1e-12);
}

TEST(OutlineBeyond, LabelsOneSideOfALine) {
  const RegionOfInterest body({{{0, 0}, {100, 0}, {100, 100}, {0, 100}}});
  const Polyline line = {{45, -2}, {30, 30}, {-2, 60}};
  for (const auto& [towards, corner, opposite] :
       {std::tuple(Point<2>(0, 0), 7, 0), std::tuple(Point<2>(100, 100), 0, 7)}) {
    const auto outline = outline_beyond(line, body.bounds(), towards, 7, "edge");
    const DomainMesh domain = mesh_domain(body, {outline}, {.edge_length = 15});
    for (std::size_t t = 0; t < domain.mesh.simplices.size(); ++t) {
      const Point<2> c = simplex_centroid(domain.mesh, static_cast<int>(t));
      const bool in_corner = point_in_polygon(Polyline{{0, 0}, {44.1, 0}, {30, 30}, {0, 58.1}}, c);
      EXPECT_EQ(domain.mesh.regions[t], in_corner ? corner : opposite) << c.transpose();
    }
    EXPECT_FALSE(domain.chains.empty());
  }
  EXPECT_THROW(outline_beyond({{1, 1}}, body.bounds(), {0, 0}, 7, "edge"), InvalidInput);
}

}  // namespace crease

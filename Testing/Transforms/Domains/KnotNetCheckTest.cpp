#include "Transforms/Domains/KnotNetCheck.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "Core/Error.h"
#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/KnotTriangles.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A square of side 4 with its cubic knots; vertex 12 is the middle one, 2 lies on the lower border.
KnotNet<2> square_net() {
  DomainMesh domain;
  domain.mesh = structured_triangulation(testing::box(0, 0, 4, 4), 4, 4);
  return place_knots(domain).net;
}

void expect_refused(const KnotNet<2>& net, const std::string& part) {
  EXPECT_THAT([&] { validate(net); }, ThrowsMessage<InvalidInput>(HasSubstr(part)));
}

}  // namespace

TEST(KnotNetCheck, PlacedNetsPass) { EXPECT_NO_THROW(validate(square_net())); }

TEST(KnotNetCheck, BorderCloudsInsideTheDomainAreRefused) {
  auto net = square_net();
  net.clouds[2][1] = Point<2>(2.05, 0.1);
  expect_refused(net, "into the domain");
}

TEST(KnotNetCheck, BorderCloudsThatReachAcrossANotchAreRefused) {
  // Two squares with a gap of 0.2 between them, joined at the bottom.
  KnotNet<2> net;
  net.degree = 2;
  net.mesh.vertices = {{0, 0},   {2, 0},   {2.2, 0}, {4.2, 0},  {0, 2},   {2, 2},
                       {2.2, 2}, {4.2, 2}, {0, -1},  {2.1, -1}, {4.2, -1}};
  net.mesh.simplices = {{0, 1, 5}, {0, 5, 4}, {2, 3, 7}, {2, 7, 6}, {8, 9, 0},
                        {9, 1, 0}, {9, 2, 1}, {9, 3, 2}, {9, 10, 3}};
  for (const auto& v : net.mesh.vertices) net.clouds.push_back({v, v});
  EXPECT_NO_THROW(validate(net));
  net.clouds[5][1] = Point<2>(2.4, 2.05);  // out of its own square, but over the other one
  expect_refused(net, "into the domain");
}

TEST(KnotNetCheck, FoldedAndFlatTrianglesAreRefused) {
  auto net = square_net();
  std::swap(net.mesh.simplices[3][0], net.mesh.simplices[3][1]);
  expect_refused(net, "folded");
  net = square_net();
  net.mesh.vertices[12] = net.clouds[12][0] = net.clouds[12][1] = net.clouds[12][2] = {2, 1};
  expect_refused(net, "folded or flat");
}

TEST(KnotNetCheck, ConditionsOneAndTwo) {
  auto net = square_net();
  net.clouds[12][1] = Point<2>(2, 0.4);  // across the edges opposite to the vertex
  expect_refused(net, "span a triangle");
  // Each knot triangle is positive, but those of the two knots have little in common.
  const std::vector<Point<2>> a = {{0, 0}, {-0.1, 0.8}}, b = {{1, 0}, {1.1, 0.8}},
                              c = {{0.5, 1}, {0.5, 0.1}};
  const TriangleClouds clouds = {a, b, c};
  EXPECT_GT(smallest_knot_triangle(clouds, 1), 0);
  EXPECT_FALSE(has_core({a, b, c}, 2) && smallest_knot_triangle(clouds, 2) > 0);
}

TEST(KnotNetCheck, SizesAndNumbersAreChecked) {
  auto net = square_net();
  net.clouds[4].pop_back();
  expect_refused(net, "vertex 4 has 2 knots");
  net = square_net();
  net.clouds.pop_back();
  expect_refused(net, "24 clouds for 25");
  net = square_net();
  net.clouds[6][0].x() += 0.1;
  expect_refused(net, "vertex 6 is not the vertex");
  net = square_net();
  net.clouds[6][1].x() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(net, "not finite");
  net = square_net();
  net.degree = 6;
  expect_refused(net, "degree 6");
  net = square_net();
  net.crease_edges.push_back({{0, 24}, false});
  expect_refused(net, "crease edge 0, 24");
  net = square_net();
  net.mesh.simplices[0][0] = 99;
  expect_refused(net, "names vertex 99");
  net = square_net();
  net.mesh.regions.pop_back();
  expect_refused(net, "regions");
}

TEST(KnotNetCheck, EdgesOfThreeTrianglesAreRefused) {
  auto net = square_net();
  net.mesh.simplices.push_back(net.mesh.simplices[0]);
  net.mesh.regions.push_back(0);
  expect_refused(net, "more than two triangles");
}

TEST(KnotTriangles, CoreShareOfCollapsedCloudsIsOne) {
  const std::vector<Point<2>> a(3, {0, 0}), b(3, {1, 0}), c(3, {0, 1});
  EXPECT_NEAR(core_share({a, b, c}, 3), 1, 1e-14);
  EXPECT_NEAR(smallest_knot_triangle({a, b, c}, 3), 1, 1e-14);
}

}  // namespace crease

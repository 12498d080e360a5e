#include "Transforms/Domains/TetrahedronKnots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Transforms/Domains/KnotNetCheck.h"
#include "Transforms/Domains/StructuredTriangulation.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

SimplexMesh<3> cubes(const std::array<int, 3>& cells) {
  Box<3> box;
  box.add({0, 0, 0});
  box.add({1.0 * cells[0], 1.0 * cells[1], 1.0 * cells[2]});
  return structured_tetrahedra(box, cells);
}

}  // namespace

TEST(TetrahedronKnots, BoxesGetValidNets) {
  for (int degree : {1, 2, 3}) {
    const auto net = place_knots(cubes({3, 2, 2}), {.degree = degree});
    EXPECT_NO_THROW(validate(net));
    for (const auto& cloud : net.clouds) {
      EXPECT_EQ(cloud.size(), static_cast<std::size_t>(degree));
      if (degree > 1) EXPECT_GT((cloud[1] - cloud[0]).norm(), 0.01);  // nothing collapses on a box
    }
  }
}

TEST(TetrahedronKnots, BorderKnotsLieOutsideAndInnerOnesWithinTheRadius) {
  const auto mesh = cubes({3, 3, 3});
  const auto net = place_knots(mesh, {.degree = 3});
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Point<3>& p = mesh.vertices[v];
    const bool inner = (p.array() > 0.5).all() && (p.array() < 2.5).all();
    for (std::size_t k = 1; k < net.clouds[v].size(); ++k) {
      const Point<3>& knot = net.clouds[v][k];
      // The insphere of a sixth of the unit cube has radius 1 / (2 + 2 sqrt 2).
      EXPECT_NEAR((knot - p).norm(), 0.5 / (2 + 2 * std::sqrt(2.0)), 1e-12);
      if (!inner) EXPECT_TRUE((knot.array() < 0).any() || (knot.array() > 3).any());
    }
  }
}

TEST(TetrahedronKnots, DoubledKnotsRepeatTheLast) {
  const auto net = place_knots(cubes({2, 2, 2}), {.degree = 3, .smoothness = 1});
  for (const auto& cloud : net.clouds) EXPECT_EQ(cloud[1], cloud[2]);
  EXPECT_NO_THROW(validate(net));
}

TEST(TetrahedronKnots, SaddleVerticesAreCollapsed) {
  // Two cubes that share one edge only meet there in a saddle; leave the corner cubes out of 2 x 2 x 1.
  auto mesh = cubes({2, 2, 1});
  SimplexMesh<3> two;
  two.vertices = mesh.vertices;
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto cube = t / 6;
    if (cube == 0 || cube == 3) two.simplices.push_back(mesh.simplices[t]);
  }
  std::vector<int> number(two.vertices.size(), -1);
  SimplexMesh<3> used;
  for (auto& s : two.simplices) {
    for (int& v : s) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(used.vertices.size());
        used.vertices.push_back(two.vertices[v]);
      }
      v = number[v];
    }
  }
  used.simplices = two.simplices;
  const auto net = place_knots(used, {.degree = 2});
  int collapsed = 0;
  for (const auto& cloud : net.clouds) collapsed += cloud[1] == cloud[0];
  EXPECT_EQ(collapsed, 2);  // the ends of the common edge
  EXPECT_NO_THROW(validate(net));
}

TEST(TetrahedronKnots, BadNetsAndOptionsAreRefused) {
  auto net = place_knots(cubes({2, 2, 2}), {.degree = 2});
  auto bad = net;
  std::swap(bad.mesh.simplices[0][0], bad.mesh.simplices[0][1]);
  EXPECT_THAT([&] { validate(bad); }, ThrowsMessage<InvalidInput>(HasSubstr("folded")));
  bad = net;
  bad.clouds[0][1] = Point<3>(0.05, 0.05, 0.02);
  EXPECT_THAT([&] { validate(bad); }, ThrowsMessage<InvalidInput>(HasSubstr("inside the domain")));
  bad = net;
  bad.clouds[13][1] = Point<3>(1, 1, 3);
  EXPECT_THAT([&] { validate(bad); }, ThrowsMessage<InvalidInput>(HasSubstr("span a tetrahedron")));
  EXPECT_THROW(place_knots(net.mesh, {.degree = 0}), InvalidInput);
  EXPECT_THROW(place_knots(net.mesh, {.degree = 2, .smoothness = 2}), InvalidInput);
  EXPECT_THROW(place_knots(net.mesh, {.degree = 2, .alpha = 1.5}), InvalidInput);
}

}  // namespace crease

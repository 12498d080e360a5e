#include "Transforms/Splines/TMesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Transforms/Splines/TSplineBasis.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Lines 0 0 1 2 .. size size of a cubic mesh.
std::vector<double> cubic_lines(int size) {
  std::vector<double> lines = {0};
  for (int k = 0; k <= size; ++k) lines.push_back(k);
  lines.push_back(size);
  return lines;
}

TMesh cubic_mesh(int size) {
  const KnotVector knots = KnotVector::even(3, 0, size, size);
  return TMesh::tensor(knots, knots);
}

/// All edges of a full grid of lines, but for a few.
std::vector<TSegment> full_grid(int lines) {
  std::vector<TSegment> segments;
  for (int axis : {0, 1}) {
    for (int line = 0; line < lines; ++line) segments.push_back({axis, line, 0, lines - 1});
  }
  return segments;
}

/// A 6 x 6 mesh with one edge more: along v at u = 2.5, from v = 2 to v = 3.
TMesh with_half_line() {
  TMesh mesh = cubic_mesh(6).with_knots({std::vector<double>{2.5}, {}});
  mesh.add({1, mesh.find_line(0, 2.5), mesh.find_line(1, 2.0), mesh.find_line(1, 3.0)});
  return mesh;
}

}  // namespace

TEST(TMesh, TensorMeshesHaveTheKnotsOfTheirVectors) {
  const KnotVector u = KnotVector::even(3, 0, 4, 4), v = KnotVector::even(3, 1, 2, 2);
  const TMesh mesh = TMesh::tensor(u, v);
  const auto vertices = mesh.vertices();
  ASSERT_EQ(std::ssize(vertices), u.num_functions() * v.num_functions());
  for (int n = 0; n < std::ssize(vertices); ++n) {
    for (int axis : {0, 1}) {
      const auto& knots = (axis == 0 ? u : v).knots();
      const int function = axis == 0 ? n % u.num_functions() : n / u.num_functions();
      const auto lines = mesh.knot_lines(axis, vertices[n]);
      for (int k = 0; k < 5; ++k) EXPECT_EQ(mesh.knot(axis, lines[k]), knots[function + k]);
    }
  }
  EXPECT_TRUE(mesh.junctions().empty());
  EXPECT_TRUE(mesh.is_analysis_suitable());
}

// The example of the rays' rule: the half line is a knot for the rays that meet it, ends included, and for
// no others.
TEST(TMesh, RaysFindKnots) {
  const TMesh mesh = with_half_line();
  EXPECT_EQ(mesh.vertices().size(), 81u + 2);
  const auto knots_at = [&](double u, double v) {
    std::vector<double> knots;
    for (int line : mesh.knot_lines(0, {mesh.find_line(0, u), mesh.find_line(1, v)})) {
      knots.push_back(mesh.knot(0, line));
    }
    return knots;
  };
  using Knots = std::vector<double>;
  EXPECT_EQ(knots_at(2, 1), (Knots{0, 1, 2, 3, 4}));
  EXPECT_EQ(knots_at(2, 2), (Knots{0, 1, 2, 2.5, 3}));
  EXPECT_EQ(knots_at(4, 3), (Knots{2.5, 3, 4, 5, 6}));
  EXPECT_EQ(knots_at(2.5, 3), (Knots{1, 2, 2.5, 3, 4}));
  EXPECT_EQ(knots_at(5, 3), (Knots{3, 4, 5, 6, 6}));
}

TEST(TMesh, ExtensionsReachOverTwoEdgesAndBackOverOne) {
  const TMesh mesh = with_half_line();
  const auto junctions = mesh.junctions();
  ASSERT_EQ(junctions.size(), 2u);
  const auto down = mesh.extension(junctions[0]);
  EXPECT_EQ(junctions[0].axis, 1);
  EXPECT_EQ(junctions[0].side, -1);
  EXPECT_EQ(mesh.knot(1, down.begin), 0);
  EXPECT_EQ(mesh.knot(1, down.end), 3);
  EXPECT_TRUE(mesh.is_analysis_suitable());
  EXPECT_EQ(mesh.faces().size(), mesh.bezier_faces().size() - 4);
}

TEST(TMesh, FindsAndMendsCrossingExtensions) {
  TMesh mesh = with_half_line().with_knots({std::vector<double>{}, {1.5}});
  mesh.add({0, mesh.find_line(1, 1.5), mesh.find_line(0, 3.0), mesh.find_line(0, 4.0)});
  mesh.check();  // a T-mesh, if not a good one
  const auto crossings = mesh.crossings();
  ASSERT_FALSE(crossings.empty());
  EXPECT_EQ(crossings[0].first.axis, 0);
  EXPECT_EQ(crossings[0].second.axis, 1);
  EXPECT_THAT([&] { TSplineBasis{mesh}; },
              ThrowsMessage<InvalidInput>(HasSubstr("(3, 1.5) and (2.5, 2) meet")));
  const TMesh mended = analysis_suitable(mesh);
  mended.check();
  EXPECT_TRUE(mended.is_analysis_suitable());
  const TSplineBasis basis(mended);
  EXPECT_NEAR(basis.evaluate({2.7, 1.7}).values.sum(), 1, 1e-14);
  // Every edge is still there.
  for (const TSegment& s : mesh.segments()) {
    for (int k = s.begin; k < s.end; ++k) {
      EXPECT_TRUE(mended.has_edge(s.axis, s.axis == 0 ? TPoint{k, s.line} : TPoint{s.line, k}));
    }
  }
}

// What the rule guards against: rays alone, without it, lose the sum.
TEST(TMesh, SumIsLostWhereExtensionsCross) {
  TMesh mesh = with_half_line().with_knots({std::vector<double>{}, {1.5}});
  mesh.add({0, mesh.find_line(1, 1.5), mesh.find_line(0, 3.0), mesh.find_line(0, 4.0)});
  double sum = 0;
  const std::array<double, 2> at = {2.7, 1.7};
  for (const TPoint& vertex : mesh.vertices()) {
    double product = 1;
    for (int axis : {0, 1}) {
      std::vector<double> knots;
      for (int line : mesh.knot_lines(axis, vertex)) knots.push_back(mesh.knot(axis, line));
      for (int k = 0; k < 4; ++k) {
        if (knots[k] <= at[axis] && at[axis] < knots[k + 1]) {
          product *= bezier_ordinates(knots, at[axis], knots[k + 1])[0];
        }
      }
      if (at[axis] < knots.front() || at[axis] >= knots.back()) product = 0;
    }
    sum += product;
  }
  EXPECT_GT(std::abs(sum - 1), 1e-3);
}

TEST(TMesh, SegmentsAreTheWholeMesh) {
  const TMesh mesh = with_half_line();
  EXPECT_EQ(TMesh(3, {mesh.lines(0), mesh.lines(1)}, mesh.segments()), mesh);
  EXPECT_EQ(mesh.with_knots({std::vector<double>{2, 2.5}, {1e-12}}), mesh);
  EXPECT_EQ(mesh.with_knots({std::vector<double>{0.3}, {5.1}}).without_empty_lines(), mesh);
}

TEST(TMesh, CompletesLooseEndsAndCorners) {
  TMesh mesh = cubic_mesh(6).without_inner_edges();
  mesh.add({0, mesh.find_line(1, 2.0), mesh.find_line(0, 2.0), mesh.find_line(0, 4.0)});
  mesh.add({1, mesh.find_line(0, 4.0), mesh.find_line(1, 2.0), mesh.find_line(1, 3.0)});
  EXPECT_THROW(mesh.check(), InvalidInput);
  mesh = rectangular(mesh);
  mesh.check();
  EXPECT_LT(mesh.vertices().size(), 81u);
}

TEST(TMesh, NamesWhatIsWrong) {
  const auto lines = cubic_lines(4);  // 7 of them
  const auto grid = full_grid(7);
  const auto expect = [&](int degree, const std::array<std::vector<double>, 2>& l,
                          const std::vector<TSegment>& segments, const char* part) {
    EXPECT_THAT([&] { TMesh(degree, l, segments); }, ThrowsMessage<InvalidInput>(HasSubstr(part)));
  };
  EXPECT_EQ(TMesh(3, {lines, lines}, grid), cubic_mesh(4));
  expect(2, {lines, lines}, grid, "the degree is 2");
  expect(3, {lines, {0, 0, 1}}, grid, "axis 1 has 3 lines");
  expect(3, {lines, {0, 0, 1, 3, 2, 4, 4}}, grid, "never decrease");
  expect(3, {lines, {0, 1, 2, 3, 3.5, 4, 4}}, grid, "must be equal");
  expect(3, {lines, {0, 0, 0, 2, 3, 4, 4}}, grid, "too often");
  expect(3, {lines, lines}, {}, "a border line is not complete");
  auto segments = grid;
  segments.push_back({0, 9, 0, 1});
  expect(3, {lines, lines}, segments, "does not lie on the lines");
  segments = grid;
  segments[3] = {0, 3, 0, 4};  // ends in front of line 5
  segments[7 + 4] = {1, 4, 0, 2};
  expect(3, {lines, lines}, segments, "an edge ends");
  segments = grid;
  segments[7 + 3] = {1, 3, 1, 6};
  expect(3, {lines, lines}, segments, "inner border line instead of the border at u = 2, v = 0");
  segments = grid;
  segments[3] = {0, 3, 0, 3};
  segments[7 + 3] = {1, 3, 3, 6};
  expect(3, {lines, lines}, segments, "edges meet in a corner at u = 2, v = 2 (lines 3, 3)");
  EXPECT_THROW(TMesh::tensor(KnotVector::even(2, 0, 1, 3), KnotVector::even(2, 0, 1, 3)),
               InvalidInput);
  EXPECT_THROW(cubic_mesh(4).find_line(0, 0.7), InvalidInput);
  EXPECT_THROW(cubic_mesh(4).on_lines({lines, {0, 0, 1, 2, 3.3, 4, 4}}), InvalidInput);
}

}  // namespace crease

// Where the splines of a net are smooth and where they bend, from one-sided limits.
#include <gtest/gtest.h>

#include "Testing/Transforms/Splines/Jumps.h"
#include "Testing/Transforms/Splines/TestNets.h"

namespace crease {
namespace {

using testing::jittered_net;
using testing::Jumps;
using testing::within_eight;

}  // namespace

TEST(TriangularBSplineSmoothness, IsSmoothAcrossKnotLines) {
  for (int degree = 1; degree <= 5; ++degree) {
    const Jumps spline(within_eight(jittered_net(2, 2, degree, 0.5, 4)), 8);
    EXPECT_EQ(spline.basis().smoothness(), degree - 1);
    const auto jumps = spline.largest_on_knot_lines();
    EXPECT_LT(jumps[0], 1e-10) << "degree " << degree;
    if (degree >= 2) EXPECT_LT(jumps[1], 1e-9) << "degree " << degree;
    if (degree >= 3) EXPECT_LT(jumps[2], 1e-7) << "degree " << degree;
    if (degree == 2) EXPECT_GT(jumps[2], 1e-2);  // a quadratic's second derivatives do jump
  }
}

TEST(TriangularBSplineSmoothness, StraightCreaseBendsAlongItsLineAndNowhereElse) {
  for (int degree = 2; degree <= 5; ++degree) {
    const auto net = within_eight(testing::straight_crease_net(degree, 0.4));
    const Jumps spline(net, 5);
    const auto crease =
        spline.largest_on_edges([&](int a, int b) { return testing::is_crease(net, a, b); });
    const auto other =
        spline.largest_on_edges([&](int a, int b) { return !testing::is_crease(net, a, b); });
    EXPECT_LT(std::max(crease[0], other[0]), 1e-11) << "degree " << degree;
    EXPECT_LT(other[1], 1e-9) << "degree " << degree;
    EXPECT_GT(crease[1], 1e-2) << "degree " << degree;
  }
}

TEST(TriangularBSplineSmoothness, CollapsedCloudsMakeHinges) {
  auto net = within_eight(jittered_net(4, 4, 3, 0.4, 3));
  const int v = 12;  // the middle
  for (auto& knot : net.clouds[v]) knot = net.clouds[v][0];
  const Jumps spline(net, 5);
  const Point<2>& middle = net.clouds[v][0];
  EXPECT_GT(spline.largest(middle, 0.9 * middle + 0.1 * net.clouds[v + 1][0])[1], 1e-2);
  EXPECT_LT(spline.largest_on_knot_lines()[0], 1e-11);
}

TEST(TriangularBSplineSmoothness, DoubledKnotsLowerIt) {
  auto net = within_eight(jittered_net(3, 3, 3, 0.4, 1));
  for (auto& cloud : net.clouds) cloud[2] = cloud[1];
  const Jumps spline(net, 8);
  EXPECT_EQ(spline.basis().smoothness(), 1);
  const auto jumps = spline.largest_on_knot_lines();
  EXPECT_LT(jumps[1], 1e-9);
  EXPECT_GT(jumps[2], 1e-2);
}

}  // namespace crease

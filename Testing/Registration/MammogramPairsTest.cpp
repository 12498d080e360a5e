// The mammogram phantom's true map, masks, outlines and pairs, of both kinds of pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "Core/Parallel.h"
#include "Testing/Registration/MammogramPhantoms.h"
#include "Transforms/Domains/Polygon.h"

namespace crease {
namespace {

using testing::parameter;
using testing::same_bytes;

constexpr double kWidthMm = testing::kMammogramFrameMm;

// The formula of the skin line, written once more: positive inside.
double inside(const Point<2>& x_mm) {
  const double x = x_mm.x() / kWidthMm, y = x_mm.y() / kWidthMm - 0.52;
  const double th = std::atan2(y, x);
  const double r = std::pow(std::pow(std::abs(std::cos(th)) / 0.55, 2.2) +
                                std::pow(std::abs(std::sin(th)) / 0.40, 2.2),
                            -1 / 2.2) *
                       (1 + 0.015 * std::sin(3 * th + 1) + 0.01 * std::sin(5 * th)) +
                   0.022 * std::exp(-std::pow((th + 0.05) / 0.045, 2));
  return r - std::hypot(x, y);
}

Matrix<2> derivative(const MammogramPhantom& phantom, const Point<2>& x) {
  const double h = 1e-4;  // mm
  Matrix<2> result;
  for (int a = 0; a < 2; ++a) {
    const Vector<2> step = h * Vector<2>::Unit(a);
    result.col(a) = (phantom.truth(x + step) - phantom.truth(x - step)) / (2 * h);
  }
  return result;
}

class MammogramPairs : public ::testing::TestWithParam<MammogramPairKind> {
 protected:
  MammogramPhantomOptions options(std::uint64_t seed = 1) const {
    return {.size = 256, .seed = seed, .pair = GetParam()};
  }
};

TEST_P(MammogramPairs, SameSeedSameBytesOnAnyNumberOfThreads) {
  auto all = options(5);
  all.mass = MammogramMassPlace::kMoving;
  const MammogramPhantom one = make_mammogram_phantom(all);
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    EXPECT_TRUE(same_bytes(one, make_mammogram_phantom(all))) << threads << " threads";
  }
  set_num_threads(0);
}

TEST_P(MammogramPairs, OtherSeedsAreOtherPhantoms) {
  const auto a = make_mammogram_phantom(options(5)), b = make_mammogram_phantom(options(6));
  EXPECT_FALSE(same_bytes(a.fixed.pixels, b.fixed.pixels));
  EXPECT_FALSE(same_bytes(a.moving.pixels, b.moving.pixels));
  EXPECT_FALSE(same_bytes(a.displacement, b.displacement));
  EXPECT_TRUE(same_bytes(a.fixed.mask, b.fixed.mask));  // one formula for all
}

TEST_P(MammogramPairs, InverseIsConsistent) {
  const auto phantom = make_mammogram_phantom(options(3));
  const double tolerance = 1e-9 * parameter(phantom, "spacing_mm");
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      const Point<2> p = kWidthMm * Point<2>(i / 20.0, j / 20.0);
      EXPECT_LT((phantom.truth(phantom.inverse(p)) - p).norm(), tolerance);
      EXPECT_LT((phantom.inverse(phantom.truth(p)) - p).norm(), tolerance);
    }
  }
}

TEST_P(MammogramPairs, DisplacementHoldsTheTruth) {
  const auto phantom = make_mammogram_phantom(options());
  for (const auto& [i, j] : {std::pair{0, 0}, {13, 57}, {128, 128}, {255, 101}}) {
    const Point<2> x = phantom.displacement.raster().point(Vector<2>(i, j));
    EXPECT_LT((x + phantom.displacement(i, j) - phantom.truth(x)).norm(), 1e-11);
  }
}

// More seeds than other tests look at, and on points that are no grid points of the phantom's own check.
TEST_P(MammogramPairs, TissueIsNeverSqueezedBelowFourTenths) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    auto small = options(seed);
    small.size = 128;
    const auto phantom = make_mammogram_phantom(small);
    const double sign = GetParam() == MammogramPairKind::kBilateral ? -1 : 1;
    double smallest = 10;
    for (int i = 0; i < 35; ++i) {
      for (int j = 0; j < 35; ++j) {
        const Matrix<2> d = derivative(phantom, kWidthMm * Point<2>(0.029 * i, 0.029 * j));
        smallest = std::min(smallest, sign * (d(0, 0) * d(1, 1) - d(0, 1) * d(1, 0)));
      }
    }
    EXPECT_GT(smallest, 0.4) << "seed " << seed;
    EXPECT_GE(smallest, parameter(phantom, "determinant_min") - 1e-4);
    EXPECT_LT(smallest, 1);
  }
}

TEST_P(MammogramPairs, MasksAreTheFormula) {
  const auto phantom = make_mammogram_phantom(options(2));
  const Raster<2>& raster = phantom.fixed.mask.raster();
  for (int j = 0; j < 256; ++j) {
    for (int i = 0; i < 256; ++i) {
      const Point<2> x = raster.point(Vector<2>(i, j));
      const double fixed = inside(x), moving = inside(phantom.inverse(x));
      if (std::abs(fixed) > 1e-12) EXPECT_EQ(phantom.fixed.mask(i, j), fixed > 0);
      if (std::abs(moving) > 1e-12) EXPECT_EQ(phantom.moving.mask(i, j), moving > 0);
    }
  }
}

TEST_P(MammogramPairs, BackgroundIsFortyToSeventyPercent) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto phantom = make_mammogram_phantom(options(seed));
    for (const auto* image : {&phantom.fixed, &phantom.moving}) {
      const auto& mask = image->mask.values();
      const double background = 1 - std::accumulate(mask.begin(), mask.end(), 0.0) / mask.size();
      EXPECT_GT(background, 0.4);
      EXPECT_LT(background, 0.7);
    }
  }
}

TEST_P(MammogramPairs, PairsFollowTheTruthAndLieOnTheOutlines) {
  const auto phantom = make_mammogram_phantom(options(4));
  const auto& landmarks = phantom.landmarks;
  const Box<2> frame = phantom.fixed.pixels.raster().bounds();
  std::map<std::string, int> kinds;
  for (int k = 0; k < landmarks.size(); ++k) {
    const Point<2>&x = landmarks.fixed[k], &y = landmarks.moving[k];
    EXPECT_EQ(phantom.truth(x), y);
    EXPECT_TRUE(frame.contains(x) && frame.contains(y));
    const std::string kind = landmarks.names[k].substr(0, landmarks.names[k].find(' '));
    ++kinds[kind];
    if (kind == "branch") {
      EXPECT_GT(inside(x), 0);
      const double a = landmarks.fixed_angle[k], b = landmarks.moving_angle[k];
      const Vector<2> carried = derivative(phantom, x) * Vector<2>(std::cos(a), std::sin(a));
      EXPECT_LT(std::abs(cross(carried.normalized(), {std::cos(b), std::sin(b)})), 1e-6);
      EXPECT_TRUE(b >= -std::numbers::pi / 2 && b < std::numbers::pi / 2);
    } else {
      EXPECT_LT(std::abs(inside(x)), 1e-12);
      // chords of the outline's 4000 points: off by less than a micrometre
      EXPECT_LT(distance_to_polyline(phantom.fixed.outline, false, x), 1e-3);
      EXPECT_LT(distance_to_polyline(phantom.moving.outline, false, y), 1e-3);
      EXPECT_TRUE(std::isnan(landmarks.fixed_angle[k]));
    }
  }
  EXPECT_GE(kinds["contour"], 36);
  EXPECT_EQ(kinds["nipple"], 1);
  EXPECT_GE(kinds["branch"], GetParam() == MammogramPairKind::kBilateral ? 12 : 20);
}

TEST_P(MammogramPairs, ContourPairsHaveEqualArcLengths) {
  const auto phantom = make_mammogram_phantom(options());
  const double length = polyline_length(phantom.fixed.outline, false);
  std::vector<Point<2>> contour;
  for (int k = 0; k < phantom.landmarks.size(); ++k) {
    if (phantom.landmarks.names[k].starts_with("contour"))
      contour.push_back(phantom.landmarks.fixed[k]);
  }
  const Polyline equal = resample_polyline(phantom.fixed.outline, false, 40);
  for (const auto& p : contour) {
    const double nearest = std::transform_reduce(
        equal.begin(), equal.end(), length, [](double a, double b) { return std::min(a, b); },
        [&](const Point<2>& q) { return (p - q).norm(); });
    EXPECT_LT(nearest, 1e-4 * length);
  }
}

TEST_P(MammogramPairs, MarksHaveTheDirectionsThatTheTruthCarries) {
  const auto phantom = make_mammogram_phantom(options(2));
  int compared = 0;
  for (const auto& mark : phantom.fixed.marks) {
    EXPECT_EQ(mark.angles_rad.size(), mark.crossing ? 2u : 3u);
    for (const auto& moved : phantom.moving.marks) {
      if (moved.name != mark.name || moved.position != phantom.truth(mark.position)) continue;
      const Matrix<2> d = derivative(phantom, mark.position);
      const double a = mark.angles_rad[0], b = moved.angles_rad[0];
      const Vector<2> carried = (d * Vector<2>(std::cos(a), std::sin(a))).normalized();
      EXPECT_LT((carried - Vector<2>(std::cos(b), std::sin(b))).norm(), 1e-6);
      ++compared;
    }
  }
  EXPECT_GE(compared, 20);
}

INSTANTIATE_TEST_SUITE_P(Kinds, MammogramPairs,
                         ::testing::Values(MammogramPairKind::kTemporal,
                                           MammogramPairKind::kBilateral),
                         [](const auto& info) {
                           return info.param == MammogramPairKind::kTemporal ? "Temporal"
                                                                             : "Bilateral";
                         });

}  // namespace
}  // namespace crease

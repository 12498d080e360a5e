#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "Registration/Mammogram/ContourPairs.h"
#include "Registration/Mammogram/MammogramAnatomy.h"
#include "Registration/Phantoms/MammogramPhantom.h"
#include "Testing/Registration/Mammogram/DrawnBreast.h"

namespace crease {
namespace {

using testing::mean_distance;

/// Phantoms of different seeds; odd ones temporal and from the side, even ones bilateral and from above; of 8, 12
/// and 16 bits.
class MammogramPhantomAnatomy : public ::testing::TestWithParam<int> {
 protected:
  static MammogramPhantomOptions options(double noise) {
    MammogramPhantomOptions options;
    options.seed = static_cast<std::uint64_t>(GetParam());
    options.noise = noise;
    options.view = GetParam() % 2 == 1 ? MammogramView::kMlo : MammogramView::kCc;
    options.pair =
        GetParam() % 2 == 1 ? MammogramPairKind::kTemporal : MammogramPairKind::kBilateral;
    options.bits = std::array{8, 12, 16}[static_cast<std::size_t>(GetParam() % 3)];
    return options;
  }
};

/// Checks all that is known; returns the mean distance of the skin line from the true one, mm.
double expect_the_truth(const MammogramImage& film) {
  const MammogramAnatomy anatomy = analyse_mammogram(film.pixels);
  const Mask<2> truth = mask_in_frame(film.mask, anatomy.frame);
  EXPECT_GE(testing::dice(anatomy.breast.mask, truth), 0.99);
  EXPECT_TRUE(anatomy.skin.nipple.has_value());
  if (anatomy.skin.nipple) {
    EXPECT_LT((anatomy.skin.nipple->point - film.nipple).norm(), 1.5);
  }
  EXPECT_LT(distance_to_polyline(anatomy.region, true, film.nipple),
            1.6);  // a pair may lie 2 outside
  EXPECT_EQ(anatomy.pectoral.has_value(), !film.pectoral.empty());
  if (anatomy.pectoral && !film.pectoral.empty()) {
    EXPECT_LT(mean_distance(anatomy.pectoral->line, film.pectoral), 0.5);
    EXPECT_LT(mean_distance(resample_polyline(film.pectoral, false, 100), anatomy.pectoral->line),
              0.5);
  }
  EXPECT_FALSE(find_self_intersection(anatomy.region, true).has_value());
  EXPECT_THAT(anatomy.warnings, ::testing::IsEmpty());
  return mean_distance(anatomy.skin.points, film.outline);
}

// 1.5 pixels with the usual noise. Four times as much lifts the threshold over the faintest 0.3 mm of skin.
TEST_P(MammogramPhantomAnatomy, IsFoundWhereItIs) {
  const MammogramPhantom usual = make_mammogram_phantom(options(0.004));
  const MammogramPhantom noisy = make_mammogram_phantom(options(0.015));
  EXPECT_LE(0.5 * (expect_the_truth(usual.fixed) + expect_the_truth(usual.moving)), 0.3);
  EXPECT_LE(0.5 * (expect_the_truth(noisy.fixed) + expect_the_truth(noisy.moving)), 0.45);
}

// Arc length knows nothing of how much of either contour the frame cuts off at the chest wall: a few mm.
TEST_P(MammogramPhantomAnatomy, ContourPairsFollowTheTrueMap) {
  const MammogramPhantom phantom = make_mammogram_phantom(options(0.004));
  const MammogramAnatomy fixed = analyse_mammogram(phantom.fixed.pixels);
  MammogramAnatomy moving = analyse_mammogram(phantom.moving.pixels);
  if (moving.breast.side != fixed.breast.side) moving = mirrored(moving);
  EXPECT_THAT(check_views(fixed, moving), ::testing::IsEmpty());
  const ContourPairs pairs = contour_pairs(fixed, moving);
  EXPECT_TRUE(pairs.nipple_used);
  const AffineMap<2> back = moving.to_given();
  double sum = 0;
  for (std::size_t k = 0; k < pairs.landmarks.fixed.size(); ++k) {
    const Point<2> q = back(pairs.landmarks.moving[k]);
    const double error = (phantom.truth(pairs.landmarks.fixed[k]) - q).norm();
    sum += error / static_cast<double>(pairs.landmarks.fixed.size());
    if (pairs.landmarks.names[k] == "nipple") EXPECT_LT(error, 2.0);
  }
  EXPECT_LT(sum, 6.0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, MammogramPhantomAnatomy, ::testing::Range(1, 11));

}  // namespace
}  // namespace crease

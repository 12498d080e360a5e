// Patches divided where the residual force asks for it: a motion in one corner that the mesh is too coarse for.
#include "Registration/AdaptiveRegistration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "Registration/CreasedDomain.h"
#include "Registration/Phantoms/Random.h"
#include "Testing/Registration/TestScenes.h"

namespace crease {
namespace {

class AdaptiveRegistration : public ::testing::Test {
 protected:
  static constexpr int kSize = 128;
  static constexpr double kEdge = 40;  // mm, five times the motion's deviation
  const Raster<2> raster = testing::raster_of<2>(kSize);
  const Point<2> middle{38, 44};

  /// 2.5 mm, in a disc of some 16 mm.
  Point<2> truth(const Point<2>& x) const {
    const double r2 = (x - middle).squaredNorm() / (8.0 * 8.0);
    return x + Vector<2>(2.5, -1) * std::exp(-0.5 * r2);
  }
  Image<float, 2> fixed(bool moved, double noise) const {
    auto image = testing::image_of<2>(
        raster, [&](const Point<2>& x) { return moved ? truth(x) : Point<2>(x); });
    add_noise(image, noise, 1);
    return image;
  }
  Image<float, 2> moving(double noise) const {
    auto image = testing::scene_image<2>(raster);
    add_noise(image, noise, 2);
    return image;
  }
  static void add_noise(Image<float, 2>& image, double deviation, std::uint64_t stream) {
    Random random(1, stream);
    for (float& v : image.values()) v += static_cast<float>(deviation * random.normal());
  }
  CreasedDomain domain(const std::vector<FinerPlace<2>>& places) const {
    CreasedDomainOptions options{.edge_length = kEdge};
    for (const auto& place : places) {
      options.fine_discs.push_back({place.centre, place.radius, place.edge_length});
    }
    return make_creased_domain(rectangle_of(raster), {}, options);
  }
  AdaptiveComposition<2> composition(bool moved, double noise,
                                     const Landmarks<2>& landmarks = {}) const {
    AdaptiveComposition<2> parts;
    parts.make_basis = [this](const auto& places) { return domain(places).basis; };
    parts.compose = [this, moved, noise, landmarks](const auto& basis) {
      Registration<2> registration(fixed(moved, noise), moving(noise));
      registration.basis(basis)
          .initial({})
          .energy("bending", default_bending_weight(*basis), bending<2>())
          .schedule({.levels = 2, .adapt_weights = true});
      if (!landmarks.empty()) registration.landmarks(landmarks);
      return registration;
    };
    return parts;
  }
  /// Root mean square error within 24 mm of the motion's middle.
  double error(const RegistrationResult<2>& result) const {
    double sum = 0, count = 0;
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) {
        const Point<2> x(i, j);
        if ((x - middle).norm() > 24) continue;
        sum += (result.transform->map(x) - truth(x)).squaredNorm();
        ++count;
      }
    }
    return std::sqrt(sum / count);
  }
};

TEST_F(AdaptiveRegistration, DividesPatchesWhereTheMotionIs) {
  auto parts = composition(true, 0.01);
  parts.most_rounds = 0;
  const auto coarse = register_adaptively(parts);
  EXPECT_TRUE(coarse.rounds.empty());
  parts.most_rounds = 3;
  const auto adaptive = register_adaptively(parts);
  ASSERT_FALSE(adaptive.rounds.empty());
  EXPECT_LT(error(adaptive.registration), 0.6 * error(coarse.registration));
  // The motion takes up a seventh of the image; patches as fine everywhere would be five times as many.
  const auto& basis = adaptive.registration.spline()->basis();
  EXPECT_LT(basis.edge_length(middle), 0.6 * kEdge);
  EXPECT_GT(basis.edge_length({112, 112}), 0.6 * kEdge);
}

TEST_F(AdaptiveRegistration, CostNeverRisesByRefining) {
  const auto adaptive = register_adaptively(composition(true, 0.03));
  ASSERT_FALSE(adaptive.rounds.empty());
  for (const auto& round : adaptive.rounds) {
    EXPECT_GT(round.places, 0);
    EXPECT_GT(round.expected_gain, 0);
    if (round.kept) EXPECT_LE(round.cost, round.cost_before);
  }
  EXPECT_LE(adaptive.registration.cost, adaptive.rounds.front().cost_before);
}

TEST_F(AdaptiveRegistration, LeavesPatchesAloneWhereOnlyNoiseIsLeft) {
  for (const double noise : {0.0, 0.02, 0.1}) {
    const auto adaptive = register_adaptively(composition(false, noise));
    EXPECT_TRUE(adaptive.rounds.empty()) << "noise " << noise;
  }
}

TEST_F(AdaptiveRegistration, KeepsExactLandmarks) {
  Landmarks<2> landmarks;
  for (const Point<2>& p : {middle, Point<2>(30.5, 50.25), Point<2>(100, 20)}) {
    landmarks.fixed.push_back(p);
    landmarks.moving.push_back(truth(p));
  }
  const auto adaptive = register_adaptively(composition(true, 0.02, landmarks));
  ASSERT_FALSE(adaptive.rounds.empty());
  for (const double miss : adaptive.registration.landmark_errors_mm) {
    EXPECT_LT(miss, 1e-9 * kSize);
  }
}

TEST_F(AdaptiveRegistration, StopsWhenCancelled) {
  int calls = 0;
  const auto adaptive = register_adaptively(
      composition(true, 0.01), [&](const RegistrationProgress&) { return ++calls < 5; });
  EXPECT_EQ(calls, 5);
  EXPECT_TRUE(adaptive.rounds.empty());
  EXPECT_NE(adaptive.registration.transform, nullptr);
}

}  // namespace
}  // namespace crease

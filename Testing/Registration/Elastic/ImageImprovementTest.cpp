#include "Registration/Elastic/ImageImprovement.h"

#include <gtest/gtest.h>

#include "Testing/Registration/Elastic/RefinementScene.h"

namespace crease {
namespace {

using testing::RefinementScene;

ImageImprovement improvement_of(const RefinementScene& scene, const Mask<2>* mask = nullptr) {
  return {scene.fixed, scene.moving, mask, scene.basis->bind(scene.raster)};
}

}  // namespace

// No map changes nothing, the map that made the fixed image leaves but its interpolation, and the opposite
// map does harm.
TEST(ImageImprovement, IsTheShareOfSquaredDifferencesThatAMapTakesAway) {
  RefinementScene scene;
  scene.fixed =
      testing::image_of<2>(scene.raster, [&](const Point<2>& x) { return scene.start->map(x); });
  const auto improvement = improvement_of(scene);
  EXPECT_FALSE(improvement.equal());
  EXPECT_NEAR(improvement.percent(SplineTransform<2>(scene.basis)).value(), 0, 1e-9);
  EXPECT_GT(improvement.percent(*scene.start).value(), 99.9);
  SplineTransform<2> opposite(scene.basis);
  opposite.set_control_points(-scene.start->control_points());
  EXPECT_LT(improvement.percent(opposite).value(), -50);
}

TEST(ImageImprovement, ComposesARefinementWithTheDeformation) {
  const RefinementScene scene;
  const auto improvement = improvement_of(scene);
  const double alone = improvement.percent(*scene.start).value();
  const SplineTransform<2> rest(scene.basis);
  EXPECT_NEAR(improvement.percent(*scene.start, &rest).value(), alone, 1e-3);
  const auto refined = scene.refine();
  EXPECT_GT(improvement.percent(*scene.start, refined.transform.get()).value(), alone + 10);
}

TEST(ImageImprovement, IsUndefinedForEqualImages) {
  RefinementScene scene;
  scene.fixed = scene.moving;
  const auto improvement = improvement_of(scene);
  EXPECT_TRUE(improvement.equal());
  EXPECT_FALSE(improvement.percent(*scene.start).has_value());
}

TEST(ImageImprovement, CountsTheMaskAlone) {
  RefinementScene scene;
  Mask<2> mask(scene.raster, 1);
  for (int j = 0; j < 96; ++j) {
    for (int i = 40; i < 96; ++i) {
      mask(i, j) = 0;
      scene.fixed(i, j) = 5;
    }
  }
  EXPECT_GT(improvement_of(scene, &mask).percent(*scene.start).value(),
            improvement_of(scene).percent(*scene.start).value() + 10);
}

}  // namespace crease

#include "Registration/Mammogram/MammogramAnatomy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Registration/Phantoms/Random.h"
#include "Testing/Registration/Mammogram/DrawnBreast.h"

namespace crease {
namespace {

using ::testing::Contains;
using testing::draw_breast;
using testing::DrawnBreast;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

double largest_distance(const Polyline& a, const Polyline& b) {
  if (a.size() != b.size()) return HUGE_VAL;
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

TEST(MammogramAnatomy, RegionIsASimplePolygonOfTheBreastsArea) {
  for (const bool pectoral : {false, true}) {
    for (const int height : {700, 480}) {  // free, and cut by the film's edges
      const DrawnBreast drawn = draw_breast({.height = height, .pectoral = pectoral});
      const MammogramAnatomy anatomy = analyse_mammogram(drawn.image);
      EXPECT_FALSE(find_self_intersection(anatomy.region, true).has_value());
      EXPECT_NEAR(std::abs(signed_area(anatomy.region)), anatomy.breast.area_mm2,
                  0.02 * anatomy.breast.area_mm2);
      EXPECT_EQ(anatomy.pectoral.has_value(), pectoral);
      EXPECT_EQ(anatomy.feature_lines().size(), pectoral ? 1u : 0u);
    }
  }
}

TEST(MammogramAnatomy, PointsLieInTheImagesGeometry) {
  const DrawnBreast drawn = draw_breast({.pectoral = true});
  Raster<2> raster = drawn.image.raster();
  raster.origin = {-40, 25};
  const MammogramAnatomy here = analyse_mammogram(drawn.image);
  const MammogramAnatomy there = analyse_mammogram(Image<float, 2>(raster, drawn.image.values()));
  const auto moved = [&](Polyline points) {
    for (auto& p : points) p += raster.origin;
    return points;
  };
  EXPECT_LT(largest_distance(there.skin.points, moved(here.skin.points)), 1e-6);
  EXPECT_LT(largest_distance(there.pectoral->line, moved(here.pectoral->line)), 1e-6);
  EXPECT_LT(largest_distance(there.region, moved(here.region)), 1e-6);
}

TEST(MammogramAnatomy, DoesNotDependOnBitDepthOrInversion) {
  const DrawnBreast drawn = draw_breast();
  const Mask<2> reference = analyse_mammogram(drawn.image).breast.mask;
  for (const int largest : {255, 4095, 65535}) {
    const auto image = testing::quantized(drawn.image, largest);
    const MammogramAnatomy plain = analyse_mammogram(image);
    const MammogramAnatomy inverted =
        analyse_mammogram(testing::negative(image, static_cast<float>(largest)));
    EXPECT_GE(testing::dice(plain.breast.mask, reference), 0.998) << largest;
    EXPECT_GE(testing::dice(inverted.breast.mask, reference), 0.998) << largest;
  }
}

// The anatomy of the flipped image is what `mirrored` makes of the anatomy.
TEST(MammogramAnatomy, MirroredIsTheMirrorImagesAnatomy) {
  const DrawnBreast drawn = draw_breast({.pectoral = true});
  const MammogramAnatomy turned = mirrored(analyse_mammogram(testing::flipped(drawn.image)));
  const MammogramAnatomy plain = analyse_mammogram(drawn.image);
  EXPECT_TRUE(turned.mirrored);
  EXPECT_EQ(turned.breast.side, plain.breast.side);
  EXPECT_EQ(turned.breast.mask.values(), plain.breast.mask.values());
  EXPECT_EQ(turned.frame.image.values(), plain.frame.image.values());
  EXPECT_LT(largest_distance(turned.skin.points, plain.skin.points), 1e-3);
  EXPECT_LT(largest_distance(turned.pectoral->line, plain.pectoral->line), 1e-3);
  for (std::size_t i = 0; i < 512; ++i) {
    EXPECT_NEAR(turned.skin.curvature[i], plain.skin.curvature[i], 1e-3);
  }
}

TEST(MammogramAnatomy, MirroredPointsGoBackToTheGivenImage) {
  const DrawnBreast drawn = draw_breast({.pectoral = true});
  const MammogramAnatomy plain = analyse_mammogram(drawn.image), turned = mirrored(plain);
  const AffineMap<2> back = turned.to_given();
  Polyline points;
  for (const auto& p : turned.skin.points) points.push_back(back(p));
  EXPECT_LT(largest_distance(points, plain.skin.points), 1e-9);
  EXPECT_LT((back(turned.skin.nipple->point) - plain.skin.nipple->point).norm(), 1e-9);
  EXPECT_EQ(plain.to_given().linear, Matrix<2>::Identity());
  const MammogramAnatomy twice = mirrored(turned);
  EXPECT_LT(largest_distance(twice.region, plain.region), 1e-9);
  EXPECT_EQ(twice.breast.mask.values(), plain.breast.mask.values());
  EXPECT_FALSE(twice.mirrored);
}

TEST(MammogramAnatomy, HonoursTheUsersMaskThresholdAndLine) {
  const DrawnBreast drawn = draw_breast({.pectoral = true});
  MammogramOptions options;
  options.mask = drawn.mask;
  options.pectoral_line = drawn.pectoral;
  const MammogramAnatomy given = analyse_mammogram(drawn.image, options);
  EXPECT_EQ(given.breast.mask.values(), drawn.mask.values());
  EXPECT_EQ(given.pectoral->line, drawn.pectoral);
  options = {};
  options.pectoral_search = PectoralSearch::kNone;
  options.threshold = 0.9f;  // of the negative: dark is dense
  const MammogramAnatomy dark = analyse_mammogram(testing::negative(drawn.image, 1.0f), options);
  EXPECT_FALSE(dark.pectoral.has_value());
  EXPECT_NEAR(dark.breast.threshold, dark.frame.value_sum - 0.9, 1e-6);
  options.mask = Mask<2>(Raster<2>{{3, 3}});
  EXPECT_THROW(analyse_mammogram(drawn.image, options), InvalidInput);
}

TEST(MammogramAnatomy, DoesNotDependOnTheNumberOfThreads) {
  const auto image = draw_breast({.noise = 0.015, .pectoral = true}).image;
  set_num_threads(1);
  const MammogramAnatomy one = analyse_mammogram(image);
  set_num_threads(0);
  const MammogramAnatomy many = analyse_mammogram(image);
  EXPECT_EQ(one.breast.mask.values(), many.breast.mask.values());
  EXPECT_EQ(one.skin.points, many.skin.points);
  EXPECT_EQ(one.pectoral->line, many.pectoral->line);
}

TEST(MammogramAnatomy, ViewsThatFitRaiseNoWarning) {
  const MammogramAnatomy a = analyse_mammogram(draw_breast().image);
  const MammogramAnatomy b = analyse_mammogram(draw_breast({.seed = 2}).image);
  EXPECT_THAT(check_views(a, b), IsEmpty());
}

TEST(MammogramAnatomy, ViewsThatDoNotFitAreSaid) {
  const MammogramAnatomy fixed = analyse_mammogram(draw_breast().image);
  EXPECT_THAT(check_views(fixed, mirrored(fixed)), Contains(HasSubstr("mirror")));
  const MammogramAnatomy oblique = analyse_mammogram(draw_breast({.pectoral = true}).image);
  EXPECT_THAT(check_views(fixed, oblique), Contains(HasSubstr("pectoral")));
  MammogramAnatomy longer = fixed;
  longer.skin.length_mm *= 1.5;
  EXPECT_THAT([&] { check_views(fixed, longer); }, ThrowsMessage<InvalidInput>(::testing::AllOf(
                                                       HasSubstr("40 %"), HasSubstr("--force"))));
  EXPECT_THAT(check_views(fixed, longer, true), Contains(HasSubstr("40 %")));
}

/// Images that show no whole breast: every one is refused with a reason, or, where it looks like a breast all the
/// same, has an anatomy; never is there a crash or another kind of error.
TEST(MammogramAnatomy, ImagesWithoutABreastAreRefusedOrLookLikeOne) {
  const DrawnBreast drawn = draw_breast();
  const Raster<2> raster = drawn.image.raster();
  const auto make = [&](const std::function<double(int, int)>& grey) {
    Image<float, 2> image(raster);
    for (int j = 0; j < raster.size[1]; ++j) {
      for (int i = 0; i < raster.size[0]; ++i) image(i, j) = static_cast<float>(grey(i, j));
    }
    return image;
  };
  Random random(3, 1);
  const std::vector<std::pair<const char*, Image<float, 2>>> images = {
      {"noise", make([&](int, int) { return random.normal(); })},
      {"slope", make([](int i, int j) { return i + 0.1 * j; })},
      {"stripes", make([](int i, int) { return i / 40 % 2; })},
      {"bars", make([](int, int j) { return j / 40 % 2; })},
      {"one pixel", make([](int i, int j) { return i == 50 && j == 60; })},
      {"one column", make([](int i, int) { return i == 0; })},
      {"corner", make([](int i, int j) { return i + j < 60; })},
      {"truncated", make([&](int i, int j) { return j < 200 ? drawn.image(i, j) : 0.0f; })},
      {"halves", make([](int i, int) { return i < 280; })},
      {"whole", make([](int i, int j) { return i > 0 && j > 0; })},
      {"frame", make([](int i, int j) { return i < 30 || j < 30 || i > 530 || j > 670; })},
      {"huge values", make([&](int i, int j) { return 1e30 * drawn.image(i, j); })},
      {"tiny values", make([&](int i, int j) { return 1e-30 * drawn.image(i, j) - 1e-29; })},
  };
  for (const auto& [name, image] : images) {
    MammogramOptions options;
    options.name = name;
    for (const bool force : {false, true}) {
      options.force = force;
      try {
        const MammogramAnatomy anatomy = analyse_mammogram(image, options);
        EXPECT_EQ(anatomy.skin.points.size(), 512u) << name;
        EXPECT_GT(anatomy.breast.area_mm2, 0) << name;
      } catch (const InvalidInput& error) {
        EXPECT_THAT(error.what(), HasSubstr(name));
      }
    }
  }
}

// Whole numbers or not, tiny or huge, negative or not.
TEST(MammogramAnatomy, DoesNotDependOnTheUnitOrTheZeroOfGrey) {
  const DrawnBreast drawn = draw_breast();
  const Mask<2> reference = analyse_mammogram(drawn.image).breast.mask;
  for (const float unit : {1e-20f, 3.7f, 1e20f}) {
    auto image = drawn.image;
    for (float& v : image.values()) v = unit * (v - 2);
    EXPECT_GE(testing::dice(analyse_mammogram(image).breast.mask, reference), 0.998) << unit;
  }
}

TEST(MammogramAnatomy, FailuresNameTheFile) {
  MammogramOptions options;
  options.name = "left.dcm";
  options.threshold = 7;
  EXPECT_THAT([&] { analyse_mammogram(draw_breast().image, options); },
              ThrowsMessage<NoBreastFound>(HasSubstr("no breast found in left.dcm")));
}

}  // namespace
}  // namespace crease

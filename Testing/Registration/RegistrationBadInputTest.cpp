// What a user of the library reads when a registration is given what it cannot use.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "Core/Error.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Registration.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/Domains/SampleDomains.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int kSize = 64;

Image<float, 2> scene() { return testing::scene_image<2>(testing::raster_of<2>(kSize)); }

Image<float, 2> with_origin(const Point<2>& origin) {
  Raster<2> raster = testing::raster_of<2>(kSize);
  raster.origin = origin;
  return Image<float, 2>(raster, scene().values());
}

std::shared_ptr<const SplineBasis<2>> basis() {
  return std::make_shared<TensorBSplineBasis<2>>(
      covering_lattice(testing::raster_of<2>(kSize), 16.0));
}

Registration<2> registration_of(const Image<float, 2>& fixed, const Image<float, 2>& moving) {
  Registration<2> registration(fixed, moving);
  registration.basis(basis()).energy("bending", 0.1, bending<2>()).schedule({.levels = 1});
  return registration;
}

/// Both that the run fails and what it says.
void expect_refused(const Registration<2>& registration, const std::vector<std::string>& texts) {
  try {
    registration.run();
    FAIL() << "not refused: " << texts.front();
  } catch (const InvalidInput& error) {
    for (const auto& text : texts) EXPECT_THAT(error.what(), HasSubstr(text));
  }
}

}  // namespace

TEST(RegistrationBadInput, PixelsThatAreNotFinite) {
  auto bad = scene();
  bad(4, 7) = std::numeric_limits<float>::quiet_NaN();
  bad(5, 9) = std::numeric_limits<float>::infinity();
  EXPECT_THAT([&] { Registration<2>(bad, scene()); },
              ThrowsMessage<InvalidInput>(
                  AllOf(HasSubstr("fixed image"), HasSubstr("2 pixels"), HasSubstr("(4, 7)"))));
  EXPECT_THAT([&] { Registration<2>(scene(), bad); },
              ThrowsMessage<InvalidInput>(HasSubstr("moving image")));
}

TEST(RegistrationBadInput, EmptyImages) {
  EXPECT_THAT([] { Registration<2>(Image<float, 2>(), scene()); },
              ThrowsMessage<InvalidInput>(HasSubstr("fixed image is empty")));
  EXPECT_THAT([] { Registration<2>(scene(), Image<float, 2>()); },
              ThrowsMessage<InvalidInput>(HasSubstr("moving image is empty")));
}

TEST(RegistrationBadInput, ImagesThatAreConstant) {
  const Image<float, 2> flat(testing::raster_of<2>(kSize), 5);
  expect_refused(registration_of(flat, scene()), {"the fixed image is constant (5)"});
  expect_refused(registration_of(scene(), flat), {"the moving image is constant (5)"});
  // Constant only where the mask looks.
  auto half = scene();
  Mask<2> mask(half.raster(), 0);
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < 8; ++j) {
      half(i, j) = 3;
      mask(i, j) = 1;
    }
  }
  expect_refused(registration_of(half, scene()).fixed_mask(mask),
                 {"the fixed image is constant (3) inside its mask"});
  expect_refused(registration_of(scene(), half).moving_mask(mask),
                 {"the moving image is constant (3) inside its mask"});
}

TEST(RegistrationBadInput, MasksThatAreEmptyOrOfAnotherSize) {
  const Mask<2> empty(testing::raster_of<2>(kSize), 0), small(testing::raster_of<2>(8), 1);
  expect_refused(registration_of(scene(), scene()).fixed_mask(empty),
                 {"mask of the fixed image is empty"});
  expect_refused(registration_of(scene(), scene()).moving_mask(empty),
                 {"mask of the moving image is empty"});
  expect_refused(registration_of(scene(), scene()).fixed_mask(small), {"another size"});
  expect_refused(registration_of(scene(), scene()).moving_mask(small), {"another size"});
}

TEST(RegistrationBadInput, ImagesThatDoNotOverlapAfterTheStart) {
  AffineMap<2> far;
  far.offset = {1000, 0};
  expect_refused(registration_of(scene(), scene()).initial(far),
                 {"do not overlap", "(999.5, -0.5) to (1063.5, 63.5)", "(-0.5, -0.5)"});
  expect_refused(registration_of(scene(), with_origin({500, 500}))
                     .alignment({.start = AlignmentStart::kIdentity}),
                 {"do not overlap", "(499.5, 499.5)"});
}

TEST(RegistrationBadInput, DomainBesideTheFixedImage) {
  Raster<2> raster = testing::raster_of<2>(kSize);
  raster.origin = {200, 200};
  auto registration = registration_of(scene(), scene());
  registration.basis(std::make_shared<TensorBSplineBasis<2>>(covering_lattice(raster, 16.0)));
  expect_refused(registration, {"domain", "fixed image"});
}

// Any spacing, origin and direction will do: the scene, seen through another grid, is the same scene.
TEST(RegistrationBadInput, OtherSpacingOriginAndDirectionAreNoError) {
  Raster<2> raster;
  raster.size = {150, 140};
  raster.spacing = {0.5, 0.6};
  raster.origin = {68, -5};
  raster.direction << 0, -1, 1, 0;  // a quarter turn
  const auto fixed = scene();
  const auto moving = testing::image_of<2>(raster, [](const Point<2>& x) { return x; });
  // The finest level smooths each image over its own pixels: not the same here.
  const auto result = registration_of(fixed, moving)
                          .initial({})
                          .schedule({.levels = 1, .smooth_finest = false})
                          .run();
  const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
  const auto stay = [](const Point<2>& x) { return x; };
  EXPECT_LT(testing::rms_difference(fixed.raster(), found, stay, 4), 0.02);  // pixel
}

TEST(RegistrationBadInput, DegreesOutOfRange) {
  const auto region = testing::rectangle(0, 0, 50, 50);
  const std::vector<FeatureLine> no_lines;
  for (int degree : {0, 6}) {
    EXPECT_THAT([&] { make_creased_domain(region, no_lines, {.degree = degree}); },
                ThrowsMessage<InvalidInput>(AllOf(HasSubstr("degree"), HasSubstr("1 and 5"))));
    EXPECT_THAT(
        [&] {
          TensorBSplineBasis<2>(covering_lattice(testing::raster_of<2>(kSize), 16.0), degree);
        },
        ThrowsMessage<InvalidInput>(HasSubstr("degree")));
  }
}

TEST(RegistrationBadInput, BendingOfDegreeOneAndWeightsOfTissueOutOfRange) {
  const auto linear = std::make_shared<TensorBSplineBasis<2>>(
      covering_lattice(testing::raster_of<2>(kSize), 16.0), 1);
  expect_refused(registration_of(scene(), scene()).basis(linear), {"degree 1"});
  const WeightField<2> too_large = [](const Point<2>& x, int) { return x.x() < 30 ? 0.25 : 1.5; };
  auto registration = registration_of(scene(), scene());
  registration.energy("rigidity", 1, rigidity<2>(too_large));
  expect_refused(registration, {"[0, 1]", "0.25 to 1.5"});
}

TEST(RegistrationBadInput, LatticeThatIsTooFine) {
  EXPECT_THAT([] { TensorBSplineBasis<2>(covering_lattice(testing::raster_of<2>(kSize), 1e-3)); },
              ThrowsMessage<InvalidInput>(HasSubstr("spans")));
}

TEST(RegistrationBadInput, SoftLandmarkOutsideTheDomain) {
  auto registration = registration_of(scene(), scene());
  Landmarks<2> landmarks;
  landmarks.fixed = {{10, 10}, {-20, 30}};
  landmarks.moving = {{11, 10}, {-20, 31}};
  registration.landmarks(landmarks, {.mode = LandmarkMode::kSoft});
  expect_refused(registration, {"landmark 2", "19.5 mm outside"});
}

TEST(RegistrationBadInput, NothingToImproveLeavesTheStart) {
  const auto result = registration_of(scene(), scene()).initial({}).run();
  EXPECT_FALSE(result.improved);
  EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("did not improve")));
  for (const Point<2>& x : {Point<2>(3, 60), Point<2>(31.5, 31.5)}) {
    EXPECT_LT((result.transform->map(x) - x).norm(), 1e-6);
  }
}

// Goes a long way off and calls it a result.
class Wanderer final : public Optimizer {
 public:
  OptimizerResult minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                           const NullSpace*, const ProgressCallback&) const override {
    OptimizerResult result;
    result.x = start.array() + 5.0;
    result.initial_value = function.evaluate(start, nullptr, nullptr);
    result.value = function.evaluate(result.x, nullptr, nullptr);
    return result;
  }
};

TEST(RegistrationBadInput, AnEndWorseThanTheStartLeavesTheStart) {
  const auto raster = testing::raster_of<2>(96);
  const auto moved = testing::about_centre<2>(raster, Matrix<2>::Identity(), {1, 0});
  const std::vector<FeatureLine> no_lines;
  const CreasedDomain domain = make_creased_domain(rectangle_of(raster), no_lines);
  Registration<2> registration(testing::image_of<2>(raster, moved),
                               testing::scene_image<2>(raster));
  registration.basis(domain.basis)
      .initial({})
      .energy("bending", default_bending_weight(*domain.basis), bending<2>())
      .schedule({.optical_flow = false, .smooth_finest = false})
      .optimizer(std::make_shared<Wanderer>());
  const auto result = registration.run();
  EXPECT_LE(result.metric_after, result.metric_before);
  EXPECT_FALSE(result.improved);
  EXPECT_EQ(result.stopped_because, "no better map than the start was found");
  EXPECT_THAT(result.warnings, ::testing::Contains(HasSubstr("did not improve")));
  EXPECT_LT((result.transform->map({20, 30}) - Point<2>(20, 30)).norm(), 1e-12);
}

}  // namespace crease

#include "Registration/Registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Optimizers/GaussNewton.h"
#include "Optimizers/SteepestDescent.h"
#include "Registration/Phantoms/Phantom.h"
#include "Testing/Registration/TestScenes.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

template <int Dim>
std::shared_ptr<TensorBSplineBasis<Dim>> tensor_basis(const Raster<Dim>& raster, double span) {
  return std::make_shared<TensorBSplineBasis<Dim>>(covering_lattice(raster, span));
}

template <int Dim>
RegistrationResult<Dim> register_scene(const AffineMap<Dim>& truth, int size, double span) {
  const auto raster = testing::raster_of<Dim>(size);
  Registration<Dim> registration(testing::image_of<Dim>(raster, truth),
                                 testing::scene_image<Dim>(raster));
  registration.basis(tensor_basis(raster, span))
      .initial({})
      .energy("bending", 1e-3, bending<Dim>())
      .schedule({.levels = 3, .smooth_finest = false})
      .optimizer(std::make_shared<GaussNewton>());
  return registration.run();
}

Matrix<2> turn(double degrees) {
  return Eigen::Rotation2Dd(degrees * std::numbers::pi / 180).toRotationMatrix();
}

}  // namespace

TEST(Registration, RecoversATranslationOfThreePixels) {
  const auto raster = testing::raster_of<2>(128);
  const auto truth = testing::about_centre<2>(raster, Matrix<2>::Identity(), {3, -3});
  const auto result = register_scene<2>(truth, 128, 20);
  const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
  EXPECT_LT(testing::rms_difference(raster, found, truth, 8), 0.02);
  EXPECT_TRUE(result.improved);
}

TEST(Registration, RecoversARotationOfTenDegrees) {
  const auto raster = testing::raster_of<2>(128);
  const auto truth = testing::about_centre<2>(raster, turn(10), {0, 0});
  const auto result = register_scene<2>(truth, 128, 20);
  const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
  EXPECT_LT(testing::rms_difference(raster, found, truth, 20), 0.02);
}

TEST(Registration, RecoversAnAffineMapInSpace) {
  const auto raster = testing::raster_of<3>(32);
  Matrix<3> linear = Matrix<3>::Identity();
  linear(0, 1) = 0.04;
  linear(1, 1) = 0.97;
  const auto truth = testing::about_centre<3>(raster, linear, {0.8, -0.5, 0.3});
  const auto result = register_scene<3>(truth, 32, 11);
  const auto found = [&](const Point<3>& x) { return result.transform->map(x); };
  // Few samples, and what leaves the small volume pulls at its border: more than in the plane.
  EXPECT_LT(testing::rms_difference(raster, found, truth, 5), 0.1);
}

TEST(Registration, StaysAtIdentityForIdenticalImages) {
  const auto result = register_scene<2>({}, 96, 16);
  const auto raster = testing::raster_of<2>(96);
  const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
  const auto stay = [](const Point<2>& x) { return x; };
  EXPECT_LT(testing::rms_difference(raster, found, stay, 0), 1e-6);
}

// Whatever the optimizer, the null space and the reason to stop: T(p_j) = q_j.
TEST(Registration, LandmarksAreExactAfterAnyStop) {
  const Phantom phantom = make_phantom("bodies", {.size = 96});
  const double size = phantom.fixed.raster().bounds().diagonal();
  const std::vector<std::shared_ptr<const Optimizer>> optimizers = {
      std::make_shared<GaussNewton>(OptimizerOptions{.max_iterations = 1}),
      std::make_shared<GaussNewton>(OptimizerOptions{.max_iterations = 20}),
      std::make_shared<SteepestDescent>(OptimizerOptions{.max_iterations = 5})};
  for (auto kind : {NullSpaceKind::kElimination, NullSpaceKind::kQr, NullSpaceKind::kSvd}) {
    for (const auto& optimizer : optimizers) {
      for (bool cancel : {false, true}) {
        Registration<2> registration(phantom.fixed, phantom.moving);
        registration.basis(tensor_basis(phantom.fixed.raster(), 16))
            .initial({})
            .energy("bending", 0.1, bending<2>())
            .landmarks(phantom.landmarks)
            .null_space(kind)
            .optimizer(optimizer)
            .schedule({.levels = 1, .optical_flow = false});
        const auto result = registration.run([&](const RegistrationProgress& progress) {
          return !(cancel && progress.stage == "level" && progress.iteration >= 1);
        });
        ASSERT_EQ(result.landmark_errors_mm.size(), phantom.landmarks.fixed.size());
        EXPECT_LT(*std::ranges::max_element(result.landmark_errors_mm), 1e-9 * size);
      }
    }
  }
}

TEST(Registration, HasTheSameBytesOnAnyNumberOfThreads) {
  const Phantom phantom = make_phantom("blobs", {.size = 128});
  const auto run = [&](int threads) {
    set_num_threads(threads);
    Registration<2> registration(phantom.fixed, phantom.moving);
    registration.basis(tensor_basis(phantom.fixed.raster(), 16))
        .energy("bending", 0.1, bending<2>());
    const auto result = registration.run();
    set_num_threads(0);
    return result.transform->parameters();
  };
  const Eigen::VectorXd one = run(1);
  for (int threads : {2, 8}) EXPECT_TRUE(one == run(threads)) << threads << " threads";
}

TEST(Registration, RecoversTheBlobs) {
  const Phantom phantom = make_phantom("blobs", {.size = 256});
  Registration<2> registration(phantom.fixed, phantom.moving);
  registration.basis(tensor_basis(phantom.fixed.raster(), 16))
      .energy("bending", 0.01, bending<2>());
  const auto result = registration.run();
  const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
  EXPECT_LT(testing::rms_difference(phantom.fixed.raster(), found, phantom.truth, 10), 0.06);
  EXPECT_LT(result.metric_after, 0.02 * result.metric_before);
}

TEST(Registration, RefusesWhatItCannotRun) {
  const auto image = testing::scene_image<2>(testing::raster_of<2>(40));
  using ::testing::HasSubstr;
  using ::testing::ThrowsMessage;
  EXPECT_THAT([&] { Registration<2>(image, image).run(); },
              ThrowsMessage<InvalidInput>(HasSubstr("no spline basis")));
  EXPECT_THAT([&] { Registration<2>(image, image).image_weight(-1); },
              ThrowsMessage<InvalidInput>(HasSubstr("alpha")));
  EXPECT_THAT([&] { Registration<2>(image, image).energy("bending", NAN, bending<2>()); },
              ThrowsMessage<InvalidInput>(HasSubstr("bending")));
  EXPECT_THAT([&] { Registration<2>().basis(tensor_basis(image.raster(), 10.0)).run(); },
              ThrowsMessage<InvalidInput>(HasSubstr("all weights are zero")));
  Image<float, 2> constant(image.raster(), 2.0f);
  EXPECT_THAT(
      [&] { Registration<2>(constant, image).basis(tensor_basis(image.raster(), 10.0)).run(); },
      ThrowsMessage<InvalidInput>(HasSubstr("constant")));
}

}  // namespace crease

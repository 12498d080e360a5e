#include "Registration/Registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Registration/Phantoms/Phantom.h"
#include "Testing/Registration/TestScenes.h"
#include "Transforms/Splines/NurbsBasis.h"
#include "Transforms/Splines/TSplineRefinement.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

template <int Dim>
std::shared_ptr<TensorBSplineBasis<Dim>> tensor_basis(const Raster<Dim>& raster, double span) {
  return std::make_shared<TensorBSplineBasis<Dim>>(covering_lattice(raster, span));
}

}  // namespace

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

TEST(Registration, WeightedTermsSumUpToTheEnergyOfEveryIteration) {
  const Phantom phantom = make_phantom("blobs", {.size = 64});
  Registration<2> registration(phantom.fixed, phantom.moving);
  registration.basis(tensor_basis(phantom.fixed.raster(), 16))
      .energy("bending", 0.01, bending<2>())
      .schedule({.levels = 2, .adapt_weights = true});
  const auto result = registration.run();
  int iterations = 0;
  for (const LevelReport& level : result.levels) {
    ASSERT_EQ(level.term_history.size(), level.energy_history.size());
    for (std::size_t i = 0; i < level.energy_history.size(); ++i) {
      const auto& terms = level.term_history[i];
      ASSERT_EQ(terms.size(), 2u);
      EXPECT_NEAR(terms.at("image") + terms.at("bending"), level.energy_history[i],
                  1e-9 * level.energy_history[i]);
      ++iterations;
    }
  }
  EXPECT_GT(iterations, 4);
}

// NURBS of the same spans, rational or not, and a T-spline that is finer in a disc.
TEST(Registration, RecoversTheBlobsWithOtherSplines) {
  const Phantom phantom = make_phantom("blobs", {.size = 256});
  const auto& raster = phantom.fixed.raster();
  const NurbsNet<2> net = covering_nurbs(raster, 16);
  NurbsNet<2> rational = net;
  Eigen::VectorXd coefficients(9);
  coefficients << 1, 1.2, 1, 1.1, 1.4, 1.1, 1, 1.2, 1;
  rational.weights = elevated_weights(net, coefficients);
  const auto finer = [&](const Point<2>& x) {
    return (x - raster.point({90, 140})).norm() < 50 ? 8.0 : 16.0;
  };
  const std::vector<std::shared_ptr<const SplineBasis<2>>> bases = {
      std::make_shared<NurbsBasis<2>>(net), std::make_shared<NurbsBasis<2>>(rational),
      covering_tspline(raster, 16, finer)};
  for (const auto& basis : bases) {
    Registration<2> registration(phantom.fixed, phantom.moving);
    registration.basis(basis).energy("bending", 0.01, bending<2>());
    const auto result = registration.run();
    const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
    EXPECT_LT(testing::rms_difference(raster, found, phantom.truth, 10), 0.06);
    EXPECT_LT(result.metric_after, 0.02 * result.metric_before);
  }
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

TEST(Registration, MayBeCancelledAtAnyMoment) {
  const Raster<2> raster = testing::raster_of<2>(64);
  const auto basis = tensor_basis<2>(raster, 16);
  for (int last = 1; last <= 12; ++last) {
    Registration<2> registration(testing::scene_image<2>(raster), testing::scene_image<2>(raster));
    registration.basis(basis).energy("bending", 1, bending<2>());
    int calls = 0;
    const auto result =
        registration.run([&](const RegistrationProgress&) { return ++calls < last; });
    EXPECT_NE(result.transform, nullptr) << "cancelled at call " << last;
  }
}

}  // namespace crease

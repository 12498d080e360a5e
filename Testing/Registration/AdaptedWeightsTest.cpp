#include "Registration/AdaptedWeights.h"

#include <gtest/gtest.h>

#include <cmath>

#include "Registration/Phantoms/Phantom.h"
#include "Registration/Registration.h"
#include "Testing/Registration/TestScenes.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

// Two looks at the same parameters, of half the weight each, are as good as one; a clean channel counts as far
// as it determines anything.
TEST(BendingBalance, CombinesChannels) {
  const BendingBalance noisy{.image_energy = 3,
                             .counted_measure = 1000,
                             .correlated_measure = 2,
                             .determined_parameters = 50};
  BendingBalance clean = noisy;
  clean.image_energy = 0.03;
  const auto density = [](std::vector<BendingBalance> channels, std::vector<double> weights) {
    return combined(channels, weights).noise_density();
  };
  EXPECT_EQ(density({noisy}, {1}), noisy.noise_density());
  EXPECT_NEAR(density({noisy, noisy}, {1, 1}), noisy.noise_density(), 1e-12);
  EXPECT_NEAR(density({noisy, noisy}, {0.5, 0.5}), 0.5 * noisy.noise_density(), 1e-12);
  EXPECT_NEAR(density({noisy, clean}, {1, 1}), 0.505 * noisy.noise_density(), 1e-12);
  EXPECT_NEAR(density({clean, noisy}, {100, 1}), noisy.noise_density(), 1e-12);
  clean.determined_parameters = 0;
  EXPECT_NEAR(density({noisy, clean}, {1, 1}), noisy.noise_density(), 1e-12);
  EXPECT_EQ(combined(std::vector{noisy, noisy}, std::vector{1.0, 1.0}).determined_parameters, 100);
  EXPECT_FALSE(combined(std::vector{noisy, clean}, std::vector{1.0, 1.0}).noise_power);
  clean.noise_power = 1e-3;
  EXPECT_FALSE(combined(std::vector{noisy, clean}, std::vector{1.0, 1.0}).noise_power);
  EXPECT_EQ(combined(std::vector{clean, clean}, std::vector{1.0, 1.0}).noise_power, 1e-3);
}

// gamma E_S = 3/4 s n, s the noise of what n parameters leave of the samples: twice the residual's power asks
// for twice the weight, twice the bending for half.
TEST(BendingBalance, IsInProportion) {
  const BendingBalance balance{.image_energy = 3,
                               .counted_measure = 600,
                               .correlated_measure = 2,
                               .bending_energy = 5,
                               .determined_parameters = 100};
  EXPECT_DOUBLE_EQ(balance.noise_density(), 0.03);
  EXPECT_DOUBLE_EQ(balance.weight(), 0.45);
  BendingBalance other = balance;
  other.image_energy *= 2;
  EXPECT_DOUBLE_EQ(other.weight(), 2 * balance.weight());
  other = balance;
  other.bending_energy *= 2;
  EXPECT_DOUBLE_EQ(other.weight(), 0.5 * balance.weight());
  other.bending_energy = 0;
  EXPECT_TRUE(std::isinf(other.weight()));
  other = balance;
  other.determined_parameters =
      300;  // as many as there are independent samples: a fifth still tells noise
  EXPECT_DOUBLE_EQ(other.noise_density(), 0.1);
}

double mean_error(const Phantom& phantom, double weight, bool adapt) {
  Registration<2> registration(phantom.fixed, phantom.moving);
  registration
      .basis(std::make_shared<TensorBSplineBasis<2>>(covering_lattice(phantom.fixed.raster(), 16)))
      .energy("bending", weight, bending<2>())
      .schedule({.adapt_weights = adapt});
  const auto result = registration.run();
  const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
  return testing::rms_difference(phantom.fixed.raster(), found, phantom.truth, 20);
}

// Neither a clean nor a noisy pair is served by the other's weight; the balance serves both.
TEST(AdaptedWeights, SuitCleanAndNoisyImages) {
  const Phantom clean = make_phantom("blobs", {.size = 192});
  const Phantom noisy = make_phantom("blobs", {.size = 192, .noise = 0.05});
  constexpr double kSoft = 1e-4, kStiff = 0.2;
  const double clean_soft = mean_error(clean, kSoft, false);
  const double noisy_stiff = mean_error(noisy, kStiff, false);
  EXPECT_GT(mean_error(clean, kStiff, false), 4 * clean_soft);
  EXPECT_GT(mean_error(noisy, kSoft, false), 1.1 * noisy_stiff);
  for (double start : {kSoft, kStiff}) {
    EXPECT_LT(mean_error(clean, start, true), 2 * clean_soft) << start;
    EXPECT_LT(mean_error(noisy, start, true), 1.5 * noisy_stiff) << start;
  }
}

}  // namespace
}  // namespace crease

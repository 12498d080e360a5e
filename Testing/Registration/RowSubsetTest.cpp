#include "Registration/RowSubset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Phantoms/Phantom.h"
#include "Registration/Registration.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"

namespace crease {
namespace {

std::vector<int> rows_of(const RowSubset& subset, int num_rows) {
  std::vector<int> rows;
  for (int r = 0; r < num_rows; ++r) {
    if (subset.contains(r)) rows.push_back(r);
  }
  return rows;
}

const Phantom& blobs() {
  static const Phantom phantom = make_phantom("blobs", {.size = 128, .noise = 0.005});
  return phantom;
}

RegistrationResult<2> registered(double fraction, std::uint64_t seed,
                                 const MetricFactory<2>& metric) {
  Registration<2> registration(blobs().fixed, blobs().moving);
  const auto basis = testing::tensor_over<2>(blobs().fixed.raster().bounds(), 6, 3);
  registration.basis(basis)
      .initial({})
      .metric(metric)
      .energy("bending", default_bending_weight(*basis), bending<2>())
      .schedule({.optical_flow = false,
                 .adapt_weights = true,
                 .sample_fraction = fraction,
                 .seed = seed});
  return registration.run();
}

double error_of(const RegistrationResult<2>& result) {
  const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
  return testing::rms_difference(blobs().fixed.raster(), found, blobs().truth, 12);
}

}  // namespace

TEST(RowSubset, HasAllRowsUnlessFewerAreAskedFor) {
  for (const RowSubset& subset : {RowSubset(), RowSubset(50, 1.0, 3)}) {
    EXPECT_EQ(rows_of(subset, 50).size(), 50U);
    std::vector<float> weights(100, 1.0f);
    subset.apply(weights);
    EXPECT_THAT(weights, ::testing::Each(1.0f));
  }
}

// No gap is wider than two strips.
TEST(RowSubset, ChoosesTheShareEvenly) {
  for (double fraction : {0.5, 0.25, 0.1}) {
    const auto rows = rows_of(RowSubset(400, fraction, 7), 400);
    EXPECT_EQ(static_cast<double>(rows.size()), 400 * fraction);
    for (std::size_t k = 1; k < rows.size(); ++k) {
      EXPECT_LT(rows[k] - rows[k - 1], 2 / fraction);
    }
  }
  EXPECT_EQ(rows_of(RowSubset(5, 0.01, 7), 5).size(), 1U);
}

TEST(RowSubset, IsChosenByTheSeedAlone) {
  const auto rows = rows_of(RowSubset(200, 0.3, 1), 200);
  EXPECT_EQ(rows, rows_of(RowSubset(200, 0.3, 1), 200));
  EXPECT_NE(rows, rows_of(RowSubset(200, 0.3, 2), 200));
}

TEST(RowSubset, KeepsTheSumOfTheWeights) {
  std::vector<float> weights(7 * 61, 0.5f);
  const RowSubset subset(61, 0.27, 4);
  subset.apply(weights);
  EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 0.5 * 7 * 61, 1e-3);
  for (int r = 0; r < 61; ++r) {
    for (int i = 0; i < 7; ++i) EXPECT_EQ(weights[7 * r + i] > 0, subset.contains(r));
  }
}

// A term that sweeps over chosen rows only has the value, forces and curvature of one whose other samples have
// no weight.
TEST(RowSubset, LeavesOutWhatCountsNothing) {
  const Raster<2> raster = testing::raster_of<2>(48);
  const auto basis = testing::triangles_over(raster.bounds(), {.degree = 3});
  const std::shared_ptr<const BoundGrid<2>> grid = basis->bind(raster);
  const RowSubset rows(48, 0.3, 2);
  std::vector<float> weights(static_cast<std::size_t>(raster.num_samples()), 1.0f);
  rows.apply(weights);
  const auto fixed = testing::image_of<2>(
      raster, [](const Point<2>& x) { return Point<2>(1.02 * x + Vector<2>(0.3, -0.4)); });
  const std::shared_ptr<const Interpolator<2>> moving =
      make_interpolator(testing::scene_image<2>(raster));
  const ControlPoints<2> phi = ControlPoints<2>::Zero(2, basis->num_control_points());
  const auto pattern = basis->pattern();
  for (const auto& metric : {ssd<2>(), ncc<2>(), local_ncc<2>(), mutual_information<2>()}) {
    const auto evaluate = [&](const RowSubset& swept, ControlPoints<2>& gradient,
                              BlockHessian<2>& hessian) {
      const std::shared_ptr<Metric<2>> compared =
          metric(MetricInput<2>{fixed, weights, moving, nullptr});
      return ImageTerm<2>(grid, compared, {}, swept).evaluate(phi, 1, &gradient, &hessian);
    };
    ControlPoints<2> gradient = phi, expected = phi;
    BlockHessian<2> hessian(pattern), expected_hessian(pattern);
    EXPECT_DOUBLE_EQ(evaluate(rows, gradient, hessian), evaluate({}, expected, expected_hessian));
    EXPECT_LE((gradient - expected).norm(), 1e-12 * expected.norm());
    EXPECT_GT(gradient.norm(), 0);
    EXPECT_LE((hessian.to_sparse() - expected_hessian.to_sparse()).norm(),
              1e-6 * expected_hessian.to_sparse().norm());
  }
}

TEST(SampleFraction, FindsTheMotionWithAQuarterOfTheRows) {
  for (const auto& metric : {ssd<2>(), mutual_information<2>(), local_ncc<2>()}) {
    EXPECT_LT(error_of(registered(0.25, 1, metric)),
              1.1 * error_of(registered(1, 1, metric)) + 0.02);
  }
}

TEST(SampleFraction, HasTheSameBytesOnAnyNumberOfThreads) {
  set_num_threads(1);
  const Eigen::VectorXd one = registered(0.3, 5, ssd<2>()).transform->parameters();
  for (int threads : {2, 8}) {
    set_num_threads(threads);
    EXPECT_EQ(one, registered(0.3, 5, ssd<2>()).transform->parameters());
  }
  set_num_threads(0);
  EXPECT_NE(one, registered(0.3, 6, ssd<2>()).transform->parameters());
  EXPECT_EQ(registered(1, 5, ssd<2>()).transform->parameters(),
            registered(1, 6, ssd<2>()).transform->parameters());
}

TEST(SampleFraction, MustBeAShare) {
  Registration<2> registration;
  for (double fraction : {0.0, -1.0, 1.5, std::nan("")}) {
    EXPECT_THROW(registration.schedule({.sample_fraction = fraction}), InvalidInput);
  }
}

}  // namespace crease

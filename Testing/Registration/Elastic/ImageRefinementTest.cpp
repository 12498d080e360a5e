#include "Registration/Elastic/ImageRefinement.h"

#include <gmock/gmock.h>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Images/CubicBSplineInterpolator.h"
#include "Metrics/SumOfSquaredDifferences.h"
#include "Registration/Elastic/DisplacementSamples.h"
#include "Registration/ImageTerm.h"
#include "Testing/Gradients.h"
#include "Testing/Registration/Elastic/RefinementScene.h"
#include "Transforms/Energies/LinearElasticEnergy.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::RefinementScene;
using ::testing::ThrowsMessage;

/// J(v) of the scene at full resolution, over the samples in the body that stay there.
struct Cost {
  explicit Cost(const RefinementScene& scene)
      : grid(scene.basis->bind(scene.raster)), elasticity(*scene.basis, scene.options.material) {
    MetricInput<2> input;
    input.fixed = scene.fixed;
    input.moving = std::make_shared<DisplacedInterpolator<2>>(
        std::make_shared<CubicBSplineInterpolator<2>>(scene.moving),
        sample_displacement(*scene.start, *grid).components);
    for (std::int64_t k = 0; k < scene.raster.num_samples(); ++k) {
      const auto [i, j] = scene.fixed.index(k);
      const bool inner = (Vector<2>(i, j) - scene.box.lower).minCoeff() > 5 &&
                         (scene.box.upper - Vector<2>(i, j)).minCoeff() > 5;
      input.weights.push_back(inner ? 1.0f : 0.0f);
      samples.push_back(scene.raster.point({i, j}));
    }
    metric = std::make_shared<SumOfSquaredDifferences<2>>(std::move(input));
  }

  std::shared_ptr<const BoundGrid<2>> grid;
  LinearElasticEnergy<2> elasticity;
  std::vector<Point<2>> samples;
  std::shared_ptr<SumOfSquaredDifferences<2>> metric;
  double weight = 50;

  std::vector<Point<2>> mapped(const SplineTransform<2>& v) const {
    std::vector<Point<2>> points;
    for (const auto& x : samples) points.push_back(v.map(x));
    return points;
  }
  double value(const SplineTransform<2>& v) const {
    return weight * metric->evaluate(mapped(v), {}) +
           elasticity.evaluate(v.control_points(), 1, nullptr, nullptr);
  }
  ControlPoints<2> gradient(const SplineTransform<2>& v) const {
    std::vector<Vector<2>> forces(samples.size());
    metric->evaluate(mapped(v), forces);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(v.num_parameters());
    v.add_adjoint(samples, forces, sum);
    ControlPoints<2> gradient = weight * sum.reshaped(2, v.control_points().cols());
    elasticity.evaluate(v.control_points(), 1, &gradient, nullptr);
    return gradient;
  }
};

SplineTransform<2> with(const RefinementScene& scene, const ControlPoints<2>& phi) {
  SplineTransform<2> v(scene.basis);
  v.set_control_points(phi);
  return v;
}

}  // namespace

// The body force of (4.12), through both maps, is minus the derivative of J by V.
TEST(ImageRefinement, ForceIsTheDerivativeOfTheComposition) {
  const RefinementScene scene(64);
  const Cost cost(scene);
  const auto n = scene.basis->num_control_points();
  const ControlPoints<2> phi = testing::Numbers(3).columns<2>(n, 0.8);
  const ControlPoints<2> direction = testing::Numbers(9).columns<2>(n, 0.3);
  const double slope = cost.gradient(with(scene, phi)).cwiseProduct(direction).sum();
  const auto value = [&](double t) { return cost.value(with(scene, phi + t * direction)); };
  // Cubic interpolation has jumps in its third derivative.
  EXPECT_LT(testing::slope_error(value, slope, 1e-5), 1e-6);
}

// What the fused sweep sums up in single precision is the same force.
TEST(ImageRefinement, FusedSweepAgreesWithDoublePrecision) {
  const RefinementScene scene(64);
  Cost cost(scene);
  const auto n = scene.basis->num_control_points();
  const ControlPoints<2> phi = testing::Numbers(3).columns<2>(n, 0.8);
  ImageTerm<2> term(cost.grid, cost.metric, {});
  ControlPoints<2> found = ControlPoints<2>::Zero(2, n);
  const double image = term.evaluate(phi, cost.weight, &found, nullptr);
  const double elastic = cost.elasticity.evaluate(phi, 1, &found, nullptr);
  const auto expected = cost.gradient(with(scene, phi));
  EXPECT_LT((found - expected).norm(), 1e-5 * expected.norm());
  EXPECT_NEAR(cost.weight * image + elastic, cost.value(with(scene, phi)),
              1e-5 * cost.weight * image);
}

TEST(ImageRefinement, FindsASmallMotionOnTopOfALargeOne) {
  const RefinementScene scene;
  const auto result = scene.refine();
  const double before = scene.error(SplineTransform<2>(scene.basis));
  EXPECT_GT(before, 0.5);  // pixels
  EXPECT_LT(scene.error(*result.transform), 0.15 * before);
  ASSERT_EQ(result.levels.size(), 2);
  EXPECT_EQ(result.levels[0].shrink, 2);
  for (const auto& level : result.levels) {
    EXPECT_LT(level.metric_after, level.metric_before);
    EXPECT_LE(level.iterations, 12);
    for (std::size_t i = 1; i < level.history.size(); ++i) {
      EXPECT_LE(level.history[i].value, level.history[i - 1].value);
    }
  }
  EXPECT_TRUE(result.converged);
}

TEST(ImageRefinement, HoldsThePins) {
  RefinementScene scene;
  scene.options.pins.emplace_back(0.5 * (scene.box.lower + scene.box.upper));
  const auto result = scene.refine();
  for (const Point<2>& pin : scene.options.pins) {
    EXPECT_LT((result.transform->map(pin) - pin).norm(), 1e-9 * 96);
  }
}

TEST(ImageRefinement, LeavesEqualImagesAlone) {
  RefinementScene scene;
  scene.start->set_control_points(ControlPoints<2>::Zero(2, scene.basis->num_control_points()));
  scene.fixed = scene.moving;
  const auto result = scene.refine();
  EXPECT_LT(result.transform->control_points().cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(result.levels.back().iterations, 0);
  EXPECT_THAT(result.levels.back().stopped_because, HasSubstr("match to rounding"));
}

TEST(ImageRefinement, DampedIterationReachesTheSameMinimum) {
  RefinementScene scene(64);
  scene.options.levels = 1;
  scene.options.smoothing_mm = {1};
  scene.options.relative_weight = 0.01;
  scene.options.relative_decrease = 1e-9;
  scene.options.step_pixels = 0;
  scene.options.max_iterations = 3000;
  const auto newton = scene.refine();
  scene.options.method = RefinementMethod::kDamped;
  scene.options.damped_step = 0.1;
  const auto damped = scene.refine();
  const double J = newton.levels[0].history.back().value;
  EXPECT_NEAR(damped.levels[0].history.back().value, J, 1e-4 * J);
  EXPECT_GT(damped.levels[0].iterations, 5 * newton.levels[0].iterations);
  EXPECT_LE(newton.levels[0].iterations, 10);
}

TEST(ImageRefinement, LowersADampedStepThatIsTooLong) {
  RefinementScene scene(64);
  scene.options.levels = 1;
  scene.options.smoothing_mm = {1};
  scene.options.relative_weight = 0.1;
  scene.options.method = RefinementMethod::kDamped;
  scene.options.damped_step = 1;
  const auto result = scene.refine();
  EXPECT_GT(result.levels[0].halvings, 0);
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_THAT(result.warnings[0], HasSubstr("lowered to"));
  scene.options.relative_weight = 100;
  EXPECT_THAT([&] { scene.refine(); }, ThrowsMessage<SolverError>(HasSubstr("halved 10 times")));
}

TEST(ImageRefinement, GoesByAnyMetric) {
  RefinementScene scene;
  for (float& value : scene.moving.values()) value = 3 - 0.5f * value;  // other contrast
  const double before = scene.error(SplineTransform<2>(scene.basis));
  scene.options.metric = ncc<2>(true);
  EXPECT_LT(scene.error(*scene.refine().transform), 0.6 * before);
  scene.options.metric = mutual_information<2>();
  EXPECT_LT(scene.error(*scene.refine().transform), 0.6 * before);
}

TEST(ImageRefinement, AlphaBalancesTheTraces) {
  RefinementScene scene;
  scene.options.levels = 1;
  const double once = scene.refine().levels[0].weight;
  scene.options.relative_weight *= 10;
  EXPECT_NEAR(scene.refine().levels[0].weight, 10 * once, 1e-9 * once);
  scene.options.material.tissue.young *= 100;
  EXPECT_NEAR(scene.refine().levels[0].weight, 1000 * once, 1e-6 * once);
  scene.options.weight = 7;
  EXPECT_EQ(scene.refine().levels[0].weight, 7);
}

TEST(ImageRefinement, CountsTheMaskAlone) {
  RefinementScene scene;
  Mask<2> mask(scene.raster, 1);
  for (int j = 0; j < 96; ++j) {
    for (int i = 48; i < 96; ++i) {
      mask(i, j) = 0;
      scene.fixed(i, j) = 5;  // what does not count may be anything
    }
  }
  const auto result =
      refine_by_images(scene.fixed, scene.moving, &mask, *scene.start, scene.options);
  const Point<2> x(30, 50);
  const auto map = [&](const Point<2>& p) { return scene.start->map(result.transform->map(p)); };
  EXPECT_LT((map(x) - scene.truth(x)).norm(), 0.3 * (scene.start->map(x) - scene.truth(x)).norm());
}

TEST(ImageRefinement, RefusesWhatCannotBeRefined) {
  const auto refine_with = [](auto change) {
    return [change] {
      RefinementScene scene(64);
      change(scene);
      scene.refine();
    };
  };
  EXPECT_THAT(refine_with([](auto& s) { s.options.pins.pop_back(); }),
              ThrowsMessage<InvalidInput>(HasSubstr("two pins")));
  EXPECT_THAT(refine_with([](auto& s) { s.options.pins[1] = s.options.pins[0]; }),
              ThrowsMessage<InvalidInput>(HasSubstr("two pins")));
  EXPECT_THAT(refine_with([](auto& s) { s.options.relative_weight = 0; }),
              ThrowsMessage<InvalidInput>(HasSubstr("relative weight")));
  EXPECT_THAT(refine_with([](auto& s) { s.options.smoothing_mm = {}; }),
              ThrowsMessage<InvalidInput>(HasSubstr("smoothing")));
  EXPECT_THAT(refine_with([](auto& s) { s.fixed = Image<float, 2>(s.raster, 3.0f); }),
              ThrowsMessage<InvalidInput>(HasSubstr("constant")));
  EXPECT_THAT(refine_with([](auto& s) {
                Raster<2> far = s.raster;
                far.origin[0] += 1000;
                s.moving = Image<float, 2>(far, s.moving.values());
              }),
              ThrowsMessage<InvalidInput>(HasSubstr("no sample")));
}

TEST(ImageRefinement, SameBytesOnAnyNumberOfThreads) {
  const RefinementScene scene;
  set_num_threads(1);
  const Eigen::VectorXd one = scene.refine().transform->parameters();
  for (int threads : {2, 8}) {
    set_num_threads(threads);
    EXPECT_EQ(scene.refine().transform->parameters(), one);
  }
  set_num_threads(0);
}

TEST(ImageRefinement, CanBeCancelled) {
  const RefinementScene scene;
  int calls = 0;
  const auto result = refine_by_images(scene.fixed, scene.moving, nullptr, *scene.start,
                                       scene.options, [&](const RegistrationProgress& state) {
                                         EXPECT_EQ(state.stage, "refinement");
                                         return ++calls < 2;
                                       });
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.levels.size(), 1);
}

}  // namespace crease

// Gradients of all metrics by the parameters of all transforms, in double precision, in the plane and in
// space: forces carried back by the transform's adjoint.
#include <gtest/gtest.h>

#include <map>

#include "Images/LinearInterpolator.h"
#include "Metrics/LocalCorrelation.h"
#include "Metrics/MetricSum.h"
#include "Metrics/MutualInformation.h"
#include "Metrics/NormalizedCrossCorrelation.h"
#include "Metrics/SumOfSquaredDifferences.h"
#include "Metrics/TargetDisplacement.h"
#include "Testing/Gradients.h"
#include "Testing/Metrics/MetricFixture.h"
#include "Testing/Transforms/SampleBases.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/CauchyNavierTransform.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SimilarityTransform.h"
#include "Transforms/SplineTransform.h"

namespace crease {
namespace {

template <int Dim>
struct NamedMetric {
  std::string name;
  std::shared_ptr<const Metric<Dim>> metric;
  bool smooth = true;  // has a continuous third derivative, so that differences converge in order
};

template <int Dim>
std::vector<NamedMetric<Dim>> metrics() {
  auto masked = testing::test_input<Dim>();
  auto mask = testing::waves<Dim>(testing::test_raster<Dim>(), 1.1);
  for (float& v : mask.values()) v *= 0.5f;
  masked.moving_mask = std::make_shared<CubicBSplineInterpolator<Dim>>(mask);
  auto linear = testing::test_input<Dim>();
  linear.moving = std::make_shared<LinearInterpolator<Dim>>(
      testing::waves<Dim>(testing::test_raster<Dim>(), 0.6));
  const auto plain = testing::test_input<Dim>();
  std::array<std::vector<float>, Dim> target;
  for (int a = 0; a < Dim; ++a)
    target[a].assign(plain.weights.size(), 0.5f * static_cast<float>(a) - 0.7f);
  const MutualInformationOptions box, cubic{.fixed_window = FixedWindow::kCubic},
      normalized{.kind = InformationKind::kNormalized};
  std::vector<typename MetricSum<Dim>::Channel> channels = {
      {std::make_shared<SumOfSquaredDifferences<Dim>>(plain), 0.7},
      {std::make_shared<MutualInformation<Dim>>(masked, box), 2},
      {std::make_shared<LocalCorrelation<Dim>>(plain, 2), 1}};
  return {
      {"SSD, MI and LNCC", std::make_shared<MetricSum<Dim>>(std::move(channels)), false},
      {"SSD", std::make_shared<SumOfSquaredDifferences<Dim>>(plain)},
      {"SSD with moving mask", std::make_shared<SumOfSquaredDifferences<Dim>>(masked)},
      {"SSD, linear", std::make_shared<SumOfSquaredDifferences<Dim>>(linear), false},
      {"target displacement",
       std::make_shared<TargetDisplacement<Dim>>(plain.fixed.raster(), target, plain.weights)},
      {"NCC", std::make_shared<NormalizedCrossCorrelation<Dim>>(plain), false},
      {"NCC with moving mask", std::make_shared<NormalizedCrossCorrelation<Dim>>(masked), false},
      {"NCC squared", std::make_shared<NormalizedCrossCorrelation<Dim>>(masked, true), false},
      {"MI", std::make_shared<MutualInformation<Dim>>(plain, box), false},
      {"MI with moving mask", std::make_shared<MutualInformation<Dim>>(masked, box), false},
      {"MI, cubic windows", std::make_shared<MutualInformation<Dim>>(masked, cubic), false},
      {"LNCC", std::make_shared<LocalCorrelation<Dim>>(plain, 2), false},
      {"LNCC with moving mask", std::make_shared<LocalCorrelation<Dim>>(masked, 2), false},
      {"NMI", std::make_shared<MutualInformation<Dim>>(masked, normalized), false}};
}

template <int Dim>
std::vector<std::pair<std::string, std::unique_ptr<Transform<Dim>>>> transforms(
    const Box<Dim>& box) {
  const Point<Dim> centre = 0.5 * (box.lower + box.upper);
  std::vector<std::pair<std::string, std::unique_ptr<Transform<Dim>>>> all;
  all.emplace_back("rigid", std::make_unique<RigidTransform<Dim>>(centre));
  all.emplace_back("affine", std::make_unique<AffineTransform<Dim>>(centre));
  all.emplace_back("similarity", std::make_unique<SimilarityTransform<Dim>>(centre));
  all.emplace_back("elastic body", std::make_unique<CauchyNavierTransform<Dim>>(
                                       testing::jittered_centres<Dim>(box, 3)));
  for (const auto& [name, basis, integrates] : testing::sample_bases<Dim>(box)) {
    all.emplace_back(name, std::make_unique<SplineTransform<Dim>>(basis));
  }
  return all;
}

/// Parameters whose unit moves the farthest point by about a millimetre.
template <int Dim>
Eigen::VectorXd random_step(const Transform<Dim>& transform, double size, unsigned seed) {
  testing::Numbers numbers(seed);
  Eigen::VectorXd step = size * numbers.columns<1>(transform.num_parameters()).transpose();
  const bool rigid = dynamic_cast<const RigidTransform<Dim>*>(&transform) != nullptr;
  const bool affine = dynamic_cast<const AffineTransform<Dim>*>(&transform) != nullptr;
  const bool similar = dynamic_cast<const SimilarityTransform<Dim>*>(&transform) != nullptr;
  // Their first parameters are angles, scales or matrix entries, the last Dim shifts.
  if (rigid || affine || similar) step.head(step.size() - Dim) *= 0.03;
  return step;
}

template <int Dim>
void expect_gradients() {
  const auto raster = testing::test_raster<Dim>();
  for (const auto& entry : transforms<Dim>(raster.bounds())) {
    const auto& [name, transform_of_entry] = entry;
    Transform<Dim>* transform = transform_of_entry.get();
    std::vector<Point<Dim>> samples;
    for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
      for (int i = 0; i < raster.size[0]; ++i) {
        samples.push_back(raster.row_start(r) + i * raster.index_to_point().col(0));
      }
    }
    const Eigen::VectorXd rest = transform->parameters() + random_step<Dim>(*transform, 0.6, 4);
    const Eigen::VectorXd direction = random_step<Dim>(*transform, 1, 9);
    std::map<double, std::vector<Point<Dim>>> known;  // all metrics ask for the same steps
    const auto mapped_at = [&](double t) -> const std::vector<Point<Dim>>& {
      auto& mapped = known[t];
      if (!mapped.empty()) return mapped;
      transform->set_parameters(rest + t * direction);
      for (const auto& x : samples) mapped.push_back(transform->map(x));
      return mapped;
    };
    for (const NamedMetric<Dim>& compared : metrics<Dim>()) {
      const Metric<Dim>* metric = compared.metric.get();
      std::vector<Vector<Dim>> forces(samples.size());
      metric->evaluate(mapped_at(0), forces);
      Eigen::VectorXd gradient = Eigen::VectorXd::Zero(rest.size());
      transform->set_parameters(rest);
      transform->add_adjoint(samples, forces, gradient);
      const auto value = [&](double t) { return metric->evaluate(mapped_at(t), {}); };
      const double slope = gradient.dot(direction);
      const std::string what = name + ", " + compared.name;
      if (compared.smooth) {
        testing::expect_slope(value, slope, what);
      } else {  // hardly a sample crosses a pixel border or a bin within these steps
        EXPECT_LT(std::min(testing::slope_error(value, slope, 1e-4),
                           testing::slope_error(value, slope, 1e-5)),
                  1e-6)
            << what;
      }
    }
  }
}

}  // namespace

TEST(MetricDerivatives, GradientsMatchCentralDifferencesInThePlane) { expect_gradients<2>(); }
TEST(MetricDerivatives, GradientsMatchCentralDifferencesInSpace) { expect_gradients<3>(); }

}  // namespace crease

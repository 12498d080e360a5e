// What metrics of intensities have in common, and what each does not mind: their gradients by the
// parameters of transforms are tested in Testing/Registration/MetricDerivativesTest.cpp.
#include "Metrics/IntensityMetric.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Metrics/LocalCorrelation.h"
#include "Metrics/MutualInformation.h"
#include "Metrics/NormalizedCrossCorrelation.h"
#include "Testing/Metrics/MetricFixture.h"
#include "Testing/Metrics/MetricRows.h"

namespace crease {
namespace {

template <int Dim>
using Make = std::function<std::unique_ptr<Metric<Dim>>(MetricInput<Dim>)>;

template <int Dim>
struct NamedMetric {
  std::string name;
  Make<Dim> make;
  bool minds_contrast_reversal = false;
};

template <int Dim>
std::vector<NamedMetric<Dim>> metrics() {
  const auto information = [](MutualInformationOptions options) -> Make<Dim> {
    return [options](MetricInput<Dim> input) {
      return std::make_unique<MutualInformation<Dim>>(std::move(input), options);
    };
  };
  const auto correlation = [](bool squared) -> Make<Dim> {
    return [squared](MetricInput<Dim> input) {
      return std::make_unique<NormalizedCrossCorrelation<Dim>>(std::move(input), squared);
    };
  };
  return {{"NCC", correlation(false), true},
          {"NCC squared", correlation(true)},
          {"LNCC",
           [](MetricInput<Dim> input) {
             return std::make_unique<LocalCorrelation<Dim>>(std::move(input), 3);
           }},
          {"MI", information({})},
          {"MI, cubic windows", information({.fixed_window = FixedWindow::kCubic})},
          {"NMI", information({.kind = InformationKind::kNormalized})}};
}

template <int Dim>
MetricInput<Dim> masked_input() {
  auto input = testing::test_input<Dim>();
  auto mask = testing::waves<Dim>(testing::test_raster<Dim>(), 1.1);
  for (float& v : mask.values()) v *= 0.5f;
  input.moving_mask = std::make_shared<CubicBSplineInterpolator<Dim>>(mask);
  return input;
}

/// The moving image with other intensities.
template <int Dim>
MetricInput<Dim> changed_input(double gain, double offset) {
  auto input = testing::test_input<Dim>();
  auto moving = testing::waves<Dim>(testing::test_raster<Dim>(), 0.6);
  for (float& v : moving.values()) v = static_cast<float>(gain * v + offset);
  input.moving = std::make_shared<CubicBSplineInterpolator<Dim>>(moving);
  return input;
}

template <typename T>
class IntensityMetricIn : public ::testing::Test {
 public:
  static constexpr int kDim = T::value;
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(IntensityMetricIn, Dimensions);

}  // namespace

TYPED_TEST(IntensityMetricIn, RowsAgreeWithTheReference) {
  constexpr int Dim = TestFixture::kDim;
  for (const auto& [name, make, reversal] : metrics<Dim>()) {
    for (const auto& input : {testing::test_input<Dim>(), masked_input<Dim>()}) {
      SCOPED_TRACE(name);
      const auto metric = make(input);
      const auto mapped = testing::mapped_points<Dim>(metric->fixed_raster());
      std::vector<Vector<Dim>> forces(mapped.size());
      const double value = metric->evaluate(mapped, forces);
      const auto rows = testing::by_rows<Dim>(*metric, mapped);
      EXPECT_NEAR(rows.value, value, 1e-5 * std::abs(value));
      double largest = 0, error = 0;
      for (std::size_t i = 0; i < forces.size(); ++i) {
        largest = std::max(largest, forces[i].norm());
        error = std::max(error, (forces[i] - rows.forces[i]).norm());
      }
      EXPECT_GT(largest, 0);
      EXPECT_LT(error,
                1e-3 * largest);  // a box takes an intensity for its neighbour's now and then
      for (double trace : rows.curvature_trace) EXPECT_GE(trace, 0);
    }
  }
}

TYPED_TEST(IntensityMetricIn, DoNotMindGainAndOffset) {
  constexpr int Dim = TestFixture::kDim;
  for (const auto& [name, make, reversal] : metrics<Dim>()) {
    SCOPED_TRACE(name);
    const auto metric = make(testing::test_input<Dim>());
    const auto mapped = testing::mapped_points<Dim>(metric->fixed_raster());
    const double value = metric->evaluate(mapped, {});
    EXPECT_NEAR(make(changed_input<Dim>(8, 0))->evaluate(mapped, {}), value, 1e-9);
    EXPECT_NEAR(make(changed_input<Dim>(3, -40))->evaluate(mapped, {}), value, 1e-4);
    const double reversed = make(changed_input<Dim>(-1, 0))->evaluate(mapped, {});
    if (reversal) {
      EXPECT_NEAR(reversed, 2 - value, 1e-9);
    } else {
      EXPECT_NEAR(reversed, value, 1e-6);
    }
  }
}

// Whatever the images: the value is best where they are equal.
TYPED_TEST(IntensityMetricIn, AreBestForEqualImages) {
  constexpr int Dim = TestFixture::kDim;
  for (const auto& [name, make, reversal] : metrics<Dim>()) {
    SCOPED_TRACE(name);
    auto input = testing::test_input<Dim>();
    input.moving = std::make_shared<CubicBSplineInterpolator<Dim>>(input.fixed);
    const auto metric = make(std::move(input));
    const auto& raster = metric->fixed_raster();
    std::vector<Point<Dim>> identity, mapped = testing::mapped_points<Dim>(raster);
    for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
      for (int i = 0; i < raster.size[0]; ++i) {
        identity.push_back(raster.row_start(r) + i * raster.index_to_point().col(0));
      }
    }
    EXPECT_LT(metric->evaluate(identity, {}), metric->evaluate(mapped, {}) - 0.01);
    if (name.starts_with("NCC") || name == "LNCC")
      EXPECT_NEAR(metric->evaluate(identity, {}), 0, 1e-9);
    EXPECT_GT(metric->unit(), 0);
  }
}

// More samples than counts of whole numbers hold, most of them in a few cells: sums are as exact as ever.
TEST(IntensityMetric, InformationCountsManySamplesOfOneIntensity) {
  Raster<2> raster;
  raster.size = {40001, 5};
  auto fixed = testing::waves<2>(raster, 0.2), moving = testing::waves<2>(raster, 0.4);
  for (std::size_t i = 0; i < fixed.values().size(); ++i) {
    if (i % 40001 > 3000) fixed.values()[i] = moving.values()[i] = 0.25f;
  }
  MetricInput<2> input{fixed, std::vector<float>(fixed.values().size(), 3.0f),
                       std::make_shared<CubicBSplineInterpolator<2>>(moving), nullptr};
  for (auto window : {FixedWindow::kBox, FixedWindow::kCubic}) {
    MutualInformation<2> metric(input, {.fixed_window = window});
    std::vector<Point<2>> mapped;
    for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
      for (int i = 0; i < raster.size[0]; ++i) {
        mapped.emplace_back(raster.row_start(r) + i * raster.index_to_point().col(0));
      }
    }
    // The rows leave out three samples each.
    for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
      for (int i : {0, 1, 40000}) input.weights[static_cast<std::size_t>(r * 40001 + i)] = 0;
    }
    const double value = MutualInformation<2>(input, {.fixed_window = window}).evaluate(mapped, {});
    EXPECT_NEAR(testing::by_rows<2>(metric, mapped).value, value, 2e-6 * std::abs(value));
  }
}

TEST(IntensityMetric, RefusesWhatCannotBeCompared) {
  using ::testing::HasSubstr;
  using ::testing::ThrowsMessage;
  auto constant = testing::test_input<2>();
  Image<float, 2> flat(constant.fixed.raster());
  for (float& v : flat.values()) v = 3;
  constant.moving = std::make_shared<CubicBSplineInterpolator<2>>(flat);
  EXPECT_THAT([&] { MutualInformation<2> metric(constant); },
              ThrowsMessage<InvalidInput>(HasSubstr("the moving image is constant (")));
  const NormalizedCrossCorrelation<2> ncc(constant);
  EXPECT_THAT([&] { ncc.evaluate(testing::mapped_points<2>(flat.raster()), {}); },
              ThrowsMessage<SolverError>(HasSubstr("the moving image is constant")));
  for (int bins : {7, 257}) {
    EXPECT_THAT([&] { MutualInformation<2> metric(testing::test_input<2>(), {.bins = bins}); },
                ThrowsMessage<InvalidInput>(HasSubstr("give 8 to 256")));
  }
  EXPECT_THAT([&] { ncc.evaluate({}, {}); },
              ThrowsMessage<InvalidInput>(HasSubstr("ncc: 0 mapped points")));
}

TEST(IntensityMetric, SaysWhenTooFewSamplesFallInside) {
  using ::testing::HasSubstr;
  using ::testing::ThrowsMessage;
  for (const auto& [name, make, reversal] : metrics<2>()) {
    const auto metric = make(testing::test_input<2>());
    auto far = testing::mapped_points<2>(metric->fixed_raster());
    for (auto& x : far) x[0] += 1000;
    EXPECT_THAT([&] { testing::by_rows<2>(*metric, far); },
                ThrowsMessage<SolverError>(HasSubstr("0 % of the samples fall inside")));
  }
}

}  // namespace crease

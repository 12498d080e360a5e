#include "Metrics/MetricSum.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Metrics/LocalCorrelation.h"
#include "Metrics/MutualInformation.h"
#include "Metrics/SumOfSquaredDifferences.h"
#include "Testing/Metrics/MetricFixture.h"
#include "Testing/Metrics/MetricRows.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

template <int Dim>
using Channels = std::vector<typename MetricSum<Dim>::Channel>;

/// One pass, two passes, and two passes whose sums lie outside of them.
template <int Dim>
Channels<Dim> channels() {
  const auto input = testing::test_input<Dim>();
  return {{std::make_shared<SumOfSquaredDifferences<Dim>>(input), 0.5},
          {std::make_shared<MutualInformation<Dim>>(input), 2},
          {std::make_shared<LocalCorrelation<Dim>>(input, 2), 1}};
}

template <typename T>
class MetricSumIn : public ::testing::Test {
 public:
  static constexpr int kDim = T::value;
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(MetricSumIn, Dimensions);

}  // namespace

TYPED_TEST(MetricSumIn, IsTheWeightedSumInUnitsOfSquaredDifferences) {
  constexpr int Dim = TestFixture::kDim;
  MetricSum<Dim> sum(channels<Dim>());
  const auto mapped = testing::mapped_points<Dim>(sum.fixed_raster());
  const auto found = testing::by_rows<Dim>(sum, mapped);
  double value = 0;
  std::vector<Vector<Dim>> forces(mapped.size(), Vector<Dim>::Zero());
  std::vector<double> traces(found.curvature_trace.size(), 0.0);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto& [metric, weight] = sum.channels()[c];
    const double factor = weight * metric->unit();
    const auto own = testing::by_rows<Dim>(*metric, mapped);
    EXPECT_EQ(sum.values()[c], own.value);
    value += factor * own.value;
    for (std::size_t i = 0; i < forces.size(); ++i) forces[i] += factor * own.forces[i];
    for (std::size_t r = 0; r < traces.size(); ++r) traces[r] += factor * own.curvature_trace[r];
  }
  EXPECT_NEAR(found.value, value, 1e-12 * std::abs(value));
  double largest = 0, error = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    largest = std::max(largest, forces[i].norm());
    error = std::max(error, (forces[i] - found.forces[i]).norm());
  }
  EXPECT_LT(error, 1e-5 * largest);
  for (std::size_t r = 0; r < traces.size(); ++r) {
    EXPECT_NEAR(found.curvature_trace[r], traces[r], 1e-4 * traces[r]);
  }
  std::vector<Vector<Dim>> reference(mapped.size());
  EXPECT_NEAR(sum.evaluate(mapped, reference), value, 1e-5 * std::abs(value));
}

TEST(MetricSum, KnowsWhatItsChannelsKnow) {
  const MetricSum<2> sum(channels<2>());
  EXPECT_EQ(sum.name(), "ssd+mi+lncc");
  EXPECT_EQ(sum.num_passes(), 2);
  EXPECT_EQ(sum.unit(), 1);
  EXPECT_TRUE(sum.needs_map(1));  // for squared differences
  EXPECT_EQ(sum.value_pass(), 1);
  EXPECT_TRUE(sum.expects_similar_intensities());
  EXPECT_EQ(sum.noise_power(), channels<2>()[1].metric->noise_power());
  const MetricSum<2> squares({channels<2>()[0], channels<2>()[0]});
  EXPECT_EQ(squares.name(), "ssd");
  EXPECT_EQ(squares.num_passes(), 1);
  EXPECT_FALSE(squares.noise_power());
}

TEST(MetricSum, RefusesWhatCannotBeSummed) {
  const auto refused = [](Channels<2> parts, const std::string& why) {
    EXPECT_THAT([&] { MetricSum<2> sum(std::move(parts)); },
                ThrowsMessage<InvalidInput>(HasSubstr(why)));
  };
  refused({}, "no channel");
  for (double weight : {-1.0, static_cast<double>(NAN)}) {
    auto parts = channels<2>();
    parts[1].weight = weight;
    refused(parts, "channel 2 has the weight");
  }
  auto parts = channels<2>();
  for (auto& part : parts) part.weight = 0;
  refused(parts, "all channels have the weight 0");
  refused({{std::make_shared<MetricSum<2>>(channels<2>()), 1}}, "channel 1 is a sum itself");
  parts[1].metric = nullptr;
  refused(parts, "channel 2 has no metric");
  auto other = testing::test_input<2>();
  Raster<2> raster = other.fixed.raster();
  raster.origin[0] += 1;
  other.fixed = Image<float, 2>(raster, other.fixed.values());
  refused({channels<2>()[0], {std::make_shared<SumOfSquaredDifferences<2>>(other), 1}},
          "channels 1 and 2 have different grids: 42 x 37");
}

TEST(MetricSum, SaysWhichChannelHasNoOverlap) {
  auto parts = channels<2>();
  auto far = testing::test_input<2>();
  Raster<2> raster = far.fixed.raster();
  raster.origin[0] += 1000;
  far.moving = std::make_shared<CubicBSplineInterpolator<2>>(testing::waves<2>(raster, 0.6));
  parts[1].metric = std::make_shared<SumOfSquaredDifferences<2>>(far);
  MetricSum<2> sum(parts);
  const auto mapped = testing::mapped_points<2>(sum.fixed_raster());
  EXPECT_THAT([&] { testing::by_rows<2>(sum, mapped); },
              ThrowsMessage<SolverError>(HasSubstr("channel 2: ")));
}

}  // namespace crease

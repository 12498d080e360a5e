#include "Metrics/SumOfSquaredDifferences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Testing/Metrics/MetricFixture.h"
#include "Testing/Metrics/MetricRows.h"

namespace crease {
namespace {

template <typename T>
class SumOfSquaredDifferencesIn : public ::testing::Test {
 public:
  static constexpr int kDim = T::value;
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(SumOfSquaredDifferencesIn, Dimensions);

}  // namespace

TYPED_TEST(SumOfSquaredDifferencesIn, RowsAgreeWithTheReference) {
  constexpr int Dim = TestFixture::kDim;
  SumOfSquaredDifferences<Dim> metric(testing::test_input<Dim>());
  const auto mapped = testing::mapped_points<Dim>(metric.fixed_raster());
  std::vector<Vector<Dim>> forces(mapped.size());
  const double value = metric.evaluate(mapped, forces);
  const auto rows = testing::by_rows<Dim>(metric, mapped);
  EXPECT_NEAR(rows.value, value, 1e-5 * value);
  double largest = 0, error = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    largest = std::max(largest, forces[i].norm());
    error = std::max(error, (forces[i] - rows.forces[i]).norm());
  }
  EXPECT_LT(error, 2e-5 * largest);  // single precision
}

// G = w grad I grad I^T, and F = w (I_m - I_f) grad I, so w |grad I|^2 = |F|^2 / (w difference^2).
TYPED_TEST(SumOfSquaredDifferencesIn, CurvatureIsTheSquaredGradient) {
  constexpr int Dim = TestFixture::kDim;
  auto input = testing::test_input<Dim>();
  std::fill(input.weights.begin(), input.weights.end(), 1.0f);
  const auto moving = input.moving;
  const auto raster = input.fixed.raster();
  SumOfSquaredDifferences<Dim> metric(std::move(input));
  const auto mapped = testing::mapped_points<Dim>(raster);
  const auto rows = testing::by_rows<Dim>(metric, mapped);
  for (std::int64_t r = 0; r < raster.num_rows(); r += 5) {
    double expected = 0;
    for (int i = 2; i < raster.size[0] - 1; ++i) {
      const auto k = static_cast<std::size_t>(r * raster.size[0] + i);
      expected += moving->evaluate(mapped[k]).gradient.squaredNorm() * raster.sample_volume();
    }
    EXPECT_NEAR(rows.curvature_trace[static_cast<std::size_t>(r)], expected,
                1e-4 * expected + 1e-6);
  }
}

TYPED_TEST(SumOfSquaredDifferencesIn, IsZeroWithoutForceForEqualImages) {
  constexpr int Dim = TestFixture::kDim;
  auto input = testing::test_input<Dim>();
  input.moving = std::make_shared<CubicBSplineInterpolator<Dim>>(input.fixed);
  const SumOfSquaredDifferences<Dim> metric(std::move(input));
  std::vector<Point<Dim>> identity;
  const auto& raster = metric.fixed_raster();
  for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
    for (int i = 0; i < raster.size[0]; ++i) {
      identity.push_back(raster.row_start(r) + i * raster.index_to_point().col(0));
    }
  }
  EXPECT_LT(metric.evaluate(identity, {}), 1e-9);
}

TEST(SumOfSquaredDifferences, RefusesWhatCannotBeCompared) {
  const auto make = [](auto change) {
    auto input = testing::test_input<2>();
    change(input);
    SumOfSquaredDifferences<2> metric(std::move(input));
  };
  using ::testing::HasSubstr;
  using ::testing::ThrowsMessage;
  EXPECT_THAT([&] { make([](auto& in) { in.weights.assign(in.weights.size(), 0.0f); }); },
              ThrowsMessage<InvalidInput>(HasSubstr("mask is empty")));
  EXPECT_THAT([&] { make([](auto& in) { std::ranges::fill(in.fixed.values(), 3.0f); }); },
              ThrowsMessage<InvalidInput>(HasSubstr("constant")));
  EXPECT_THAT([&] { make([](auto& in) { in.fixed.values()[500] = NAN; }); },
              ThrowsMessage<InvalidInput>(HasSubstr("sample 500")));
  EXPECT_THAT([&] { make([](auto& in) { in.weights[2] = -1; }); },
              ThrowsMessage<InvalidInput>(HasSubstr("sample 2")));
  EXPECT_THAT([&] { make([](auto& in) { in.weights.pop_back(); }); },
              ThrowsMessage<InvalidInput>(HasSubstr("weights")));
}

TEST(SumOfSquaredDifferences, StopsWhenTheImagesDoNotOverlap) {
  SumOfSquaredDifferences<2> metric(testing::test_input<2>());
  auto mapped = testing::mapped_points<2>(metric.fixed_raster());
  for (auto& p : mapped) p[0] += 1000;
  EXPECT_THROW(testing::by_rows<2>(metric, mapped), SolverError);
}

}  // namespace crease

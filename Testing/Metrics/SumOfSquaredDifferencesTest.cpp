#include "Metrics/SumOfSquaredDifferences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Testing/Metrics/MetricFixture.h"

namespace crease {
namespace {

template <typename T>
class SumOfSquaredDifferencesIn : public ::testing::Test {
 public:
  static constexpr int kDim = T::value;
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(SumOfSquaredDifferencesIn, Dimensions);

/// What the row interface yields for a displacement of the samples, whole raster.
template <int Dim>
struct RowResult {
  double value = 0;
  std::vector<Vector<Dim>> forces;
  std::vector<double> curvature_trace;  // per row, summed
};

template <int Dim>
RowResult<Dim> by_rows(Metric<Dim>& metric, const std::vector<Point<Dim>>& mapped) {
  const auto& raster = metric.fixed_raster();
  const auto width = static_cast<std::size_t>(raster.size[0]);
  RowResult<Dim> result;
  std::vector<std::unique_ptr<typename Metric<Dim>::Sums>> sums;
  for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
    std::array<std::vector<float>, Dim> u, f;
    std::array<std::vector<float>, Dim*(Dim + 1) / 2> g;
    MappedRow<Dim> row;
    row.row = r;
    row.begin = 2;
    row.end = raster.size[0] - 1;
    row.start = raster.row_start(r);
    row.step = raster.index_to_point().col(0);
    ForceRow<Dim> out;
    for (int a = 0; a < Dim; ++a) {
      u[a].assign(width + 32, 0.0f);
      f[a].assign(width + 32, 0.0f);
      for (std::size_t i = 0; i < width; ++i) {
        const Point<Dim> x = row.start + static_cast<double>(i) * row.step;
        u[a][i] = static_cast<float>(mapped[static_cast<std::size_t>(r) * width + i][a] - x[a]);
      }
      row.displacement[a] = u[a].data();
      out.force[a] = f[a].data();
    }
    for (std::size_t k = 0; k < g.size(); ++k) {
      g[k].assign(width / 4 + 2, 0.0f);
      out.curvature[k] = g[k].data();
    }
    sums.push_back(metric.new_sums());
    metric.evaluate_row(0, row, out, *sums.back());
    for (std::size_t i = 0; i < width; ++i) {
      Vector<Dim> force;
      for (int a = 0; a < Dim; ++a) force[a] = f[a][i];
      const bool swept = static_cast<int>(i) >= row.begin && static_cast<int>(i) < row.end;
      result.forces.push_back(swept ? force : Vector<Dim>::Zero().eval());
    }
    double trace = 0;
    for (float v : g[0]) trace += v;
    for (float v : g[Dim == 2 ? 2 : 3]) trace += v;
    if (Dim == 3) {
      for (float v : g.back()) trace += v;
    }
    result.curvature_trace.push_back(trace);
  }
  result.value = metric.finish_pass(0, sums);
  return result;
}

}  // namespace

TYPED_TEST(SumOfSquaredDifferencesIn, RowsAgreeWithTheReference) {
  constexpr int Dim = TestFixture::kDim;
  SumOfSquaredDifferences<Dim> metric(testing::test_input<Dim>());
  const auto mapped = testing::mapped_points<Dim>(metric.fixed_raster());
  std::vector<Vector<Dim>> forces(mapped.size());
  const double value = metric.evaluate(mapped, forces);
  const auto rows = by_rows<Dim>(metric, mapped);
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
  const auto rows = by_rows<Dim>(metric, mapped);
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
  EXPECT_THROW(by_rows<2>(metric, mapped), SolverError);
}

}  // namespace crease

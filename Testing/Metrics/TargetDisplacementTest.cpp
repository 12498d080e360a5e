#include "Metrics/TargetDisplacement.h"

#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Testing/Metrics/MetricFixture.h"

namespace crease {

TEST(TargetDisplacement, RowsAgreeWithTheReferenceAndItsForceIsTheMiss) {
  Raster<3> raster;
  raster.size = {9, 4, 3};
  raster.spacing = {2, 1, 1.5};
  const auto count = static_cast<std::size_t>(raster.num_samples());
  std::array<std::vector<float>, 3> field;
  for (int a = 0; a < 3; ++a) field[a].assign(count, 0.5f * static_cast<float>(a + 1));
  TargetDisplacement<3> metric(raster, field, std::vector<float>(count, 2.0f));
  // Everything stays in place: each sample misses its target by (0.5, 1, 1.5) mm.
  std::vector<Point<3>> mapped;
  std::vector<std::unique_ptr<Metric<3>::Sums>> sums;
  std::array<std::vector<float>, 3> force;
  std::array<std::vector<float>, 6> curvature;
  for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
    for (int i = 0; i < 9; ++i) {
      mapped.emplace_back(raster.row_start(r) + i * raster.index_to_point().col(0));
    }
    MappedRow<3> row;
    row.row = r;
    row.end = 9;
    row.start = raster.row_start(r);
    row.step = raster.index_to_point().col(0);
    ForceRow<3> out;
    for (int a = 0; a < 3; ++a) {
      force[a].assign(12, 0.0f);
      out.force[a] = force[a].data();
    }
    for (int k = 0; k < 6; ++k) {
      curvature[k].assign(3, 0.0f);
      out.curvature[k] = curvature[k].data();
    }
    sums.push_back(metric.new_sums());
    metric.evaluate_row(0, row, out, *sums.back());
  }
  const double expected = 0.5 * 2 * 3.5 * raster.num_samples() * raster.sample_volume();
  EXPECT_NEAR(metric.finish_pass(0, sums), expected, 1e-9 * expected);
  std::vector<Vector<3>> forces(count);
  EXPECT_NEAR(metric.evaluate(mapped, forces), expected, 1e-9 * expected);
  EXPECT_TRUE(forces[7].isApprox(Vector<3>(-0.5, -1, -1.5) * 2 * 3, 1e-12));
  EXPECT_FLOAT_EQ(force[1][3], -6.0f);
  // Four samples of weight 2 and volume 3 per block, on the diagonal alone.
  EXPECT_FLOAT_EQ(curvature[0][0], 24.0f);
  EXPECT_FLOAT_EQ(curvature[3][0], 24.0f);
  EXPECT_FLOAT_EQ(curvature[5][1], 24.0f);
  EXPECT_FLOAT_EQ(curvature[1][0], 0.0f);
}

TEST(TargetDisplacement, RefusesFieldsThatDoNotFit) {
  Raster<2> raster;
  raster.size = {3, 3};
  const std::vector<float> nine(9, 1.0f), eight(8, 1.0f);
  EXPECT_THROW(TargetDisplacement<2>(raster, {nine, eight}, nine), InvalidInput);
  auto broken = nine;
  broken[4] = NAN;
  EXPECT_THROW(TargetDisplacement<2>(raster, {nine, broken}, nine), InvalidInput);
}

}  // namespace crease

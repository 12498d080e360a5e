#include "Core/Quantiles.h"

#include <gtest/gtest.h>

#include <numeric>

namespace crease {
namespace {

/// 0 .. count - 1 in an order of its own.
std::vector<double> shuffled(int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(7 * i % count);  // count is no multiple of 7
  return values;
}

TEST(Quantiles, TakesTheValueOfTheNearestRank) {
  const std::vector<double> values = shuffled(101);
  for (const int percent : {0, 1, 37, 50, 99, 100}) {
    EXPECT_EQ(quantile(values, percent / 100.0), percent);
  }
  EXPECT_EQ(quantile(values, 0.374), 37);
  EXPECT_EQ(quantile(values, 0.376), 38);
}

TEST(Quantiles, MedianOfAnEvenNumberIsTheUpperOfTheTwo) {
  EXPECT_EQ(median(shuffled(5)), 2);
  EXPECT_EQ(median(shuffled(6)), 3);
  EXPECT_EQ(median(std::vector<float>{4}), 4);
}

TEST(Quantiles, LeavesTheCallersValuesAsTheyAre) {
  std::vector<double> values = shuffled(9);
  median(values);
  EXPECT_EQ(values, shuffled(9));
}

TEST(Quantiles, ValueOfRankReordersInPlace) {
  std::vector<double> values = shuffled(50);
  EXPECT_EQ(value_of_rank(std::span(values), 20), 20);
  EXPECT_EQ(values[20], 20);
  EXPECT_EQ(std::accumulate(values.begin(), values.end(), 0.0), 49 * 50 / 2);
}

TEST(Quantiles, InterpolatesBetweenRanks) {
  const std::vector<double> sorted = {0, 10, 40};
  EXPECT_DOUBLE_EQ(interpolated_quantile(sorted, 0), 0);
  EXPECT_DOUBLE_EQ(interpolated_quantile(sorted, 0.25), 5);
  EXPECT_DOUBLE_EQ(interpolated_quantile(sorted, 0.5), 10);
  EXPECT_DOUBLE_EQ(interpolated_quantile(sorted, 0.75), 25);
  EXPECT_DOUBLE_EQ(interpolated_quantile(sorted, 1), 40);
}

}  // namespace
}  // namespace crease

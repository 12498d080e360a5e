#include "Transforms/GaussRule.h"

#include <gtest/gtest.h>

#include <cmath>

#include "Core/Error.h"

namespace crease {

TEST(GaussRule, IntegratesPolynomialsExactly) {
  for (int n = 1; n <= 12; ++n) {
    const auto rule = gauss_rule(n);
    for (int degree = 0; degree <= 2 * n - 1; ++degree) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += rule.weights[i] * std::pow(rule.points[i], degree);
      EXPECT_NEAR(sum, 1.0 / (degree + 1), 1e-14);
    }
    EXPECT_TRUE(std::is_sorted(rule.points.begin(), rule.points.end()));
  }
}

TEST(GaussRule, OfTwoPointsIsTheTextbooks) {
  const auto rule = gauss_rule(2);
  EXPECT_NEAR(rule.points[0], 0.5 - 0.5 / std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(rule.weights[0], 0.5, 1e-15);
  EXPECT_THROW(gauss_rule(0), InvalidInput);
}

}  // namespace crease

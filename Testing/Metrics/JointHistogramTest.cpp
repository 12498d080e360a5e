#include "Metrics/JointHistogram.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace crease {
namespace {

constexpr int kBins = 12;

JointHistogram random_histogram(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> numbers(-1, 1);
  JointHistogram histogram(kBins);
  for (int k = 0; k < kBins; ++k) {
    for (int l = 0; l < kBins; ++l) histogram.row(k)[l] = std::max(0.0, 0.5 + numbers(random));
  }
  histogram.normalise();
  return histogram;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

TEST(JointHistogram, SumsToOneAlongEveryWay) {
  const JointHistogram histogram = random_histogram(1);
  EXPECT_NEAR(sum(histogram.fixed_marginal()), 1, 1e-12);
  EXPECT_NEAR(sum(histogram.moving_marginal()), 1, 1e-12);
}

// Independent bins share no information; equal ones share all: H_f + H_m - H_fm = H.
TEST(JointHistogram, KnowsIndependenceAndIdentity) {
  JointHistogram independent(kBins), equal(kBins);
  for (int k = 0; k < kBins; ++k) {
    for (int l = 0; l < kBins; ++l) independent.row(k)[l] = (1.0 + k) * (3.0 + l * l);
    equal.row(k)[k] = 1;
  }
  independent.normalise();
  equal.normalise();
  EXPECT_NEAR(independent.information(InformationKind::kMutual).value, 0, 1e-12);
  EXPECT_NEAR(independent.information(InformationKind::kNormalized).value, 1, 1e-12);
  EXPECT_NEAR(equal.information(InformationKind::kMutual).value, std::log(kBins), 1e-12);
  EXPECT_NEAR(equal.information(InformationKind::kNormalized).value, 2, 1e-12);
}

TEST(JointHistogram, InformationIsSymmetric) {
  const JointHistogram histogram = random_histogram(2);
  JointHistogram swapped(kBins);
  for (int k = 0; k < kBins; ++k) {
    for (int l = 0; l < kBins; ++l) swapped.row(l)[k] = histogram.row(k)[l];
  }
  for (auto kind : {InformationKind::kMutual, InformationKind::kNormalized}) {
    EXPECT_NEAR(histogram.information(kind).value, swapped.information(kind).value, 1e-12);
    EXPECT_GE(histogram.information(kind).value, 0);
  }
}

// Along a change of p that keeps its sum.
TEST(JointHistogram, SlopesAreDerivatives) {
  const JointHistogram histogram = random_histogram(3);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> numbers(-1, 1);
  std::vector<double> change(kBins * kBins);
  for (double& c : change) c = numbers(random);
  for (int i = 0; i < kBins * kBins; ++i) change[i] *= histogram.row(0)[i];  // p stays above 0
  *std::max_element(change.begin(), change.end()) -= sum(change);
  for (auto kind : {InformationKind::kMutual, InformationKind::kNormalized}) {
    const auto information = histogram.information(kind);
    double slope = 0;
    for (int i = 0; i < kBins * kBins; ++i) slope += information.slope[i] * change[i];
    const double h = 1e-6;
    double values[2];
    for (int side : {0, 1}) {
      JointHistogram moved = histogram;
      for (int i = 0; i < kBins * kBins; ++i) moved.row(0)[i] += (side ? h : -h) * change[i];
      values[side] = moved.information(kind).value;
    }
    EXPECT_NEAR((values[1] - values[0]) / (2 * h), slope, 1e-6 * std::abs(slope) + 1e-9);
  }
}

// Rows that are Gaussian: the information is the reciprocal of the variance.
TEST(JointHistogram, CurvatureOfGaussiansIsTheReciprocalOfTheirVariance) {
  JointHistogram histogram(64);
  for (int k = 0; k < 64; ++k) {
    for (int l = 0; l < 64; ++l) histogram.row(k)[l] = std::exp(-0.5 * std::pow((l - 32) / 5.0, 2));
  }
  histogram.normalise();
  const auto information = histogram.information(InformationKind::kMutual);
  for (double c : information.curvature) EXPECT_NEAR(c, 1 / 25.0, 1e-3);
}

TEST(CubicWindow, IsAPartitionOfUnityWithItsDerivative) {
  for (double position : {2.0, 3.25, 7.5, 8.999}) {
    const CubicWindow window(position), next(position + 1e-6);
    EXPECT_NEAR(std::accumulate(window.value, window.value + 4, 0.0), 1, 1e-14);
    EXPECT_NEAR(std::accumulate(window.slope, window.slope + 4, 0.0), 0, 1e-14);
    double mean = 0;
    for (int l = 0; l < 4; ++l) {
      mean += (window.first + l) * window.value[l];
      if (next.first == window.first) {
        EXPECT_NEAR((next.value[l] - window.value[l]) / 1e-6, window.slope[l], 2e-6);
      }
    }
    EXPECT_NEAR(mean, position, 1e-12);
  }
}

}  // namespace crease

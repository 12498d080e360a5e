#include "Registration/Evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "Core/Error.h"
#include "Registration/EvaluationLabels.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

template <int Dim>
Raster<Dim> raster(const std::array<int, Dim>& size) {
  Raster<Dim> r;
  r.size = size;
  return r;
}

template <int Dim>
Point<Dim> position(const Raster<Dim>& r, const std::array<int, Dim>& index) {
  Vector<Dim> i;
  for (int a = 0; a < Dim; ++a) i[a] = index[a];
  return r.point(i);
}

// value(x) at every sample.
template <typename Pixel, int Dim, typename Function>
Image<Pixel, Dim> filled(const Raster<Dim>& r, const Function& value) {
  std::vector<Pixel> pixels;
  const Image<std::uint8_t, Dim> indices(r);
  for (std::int64_t i = 0; i < r.num_samples(); ++i) {
    pixels.push_back(value(position<Dim>(r, indices.index(i))));
  }
  return Image<Pixel, Dim>(r, std::move(pixels));
}

template <int Dim, typename Function>
DisplacementField<Dim> field(const Raster<Dim>& r, const Function& map) {
  return filled<Vector<Dim>>(r, [&](const Point<Dim>& x) -> Vector<Dim> { return map(x) - x; });
}

DisplacementField<2> at_rest(const Raster<2>& r) {
  return DisplacementField<2>(r, Vector<2>::Zero());
}

TEST(ErrorStatistics, OfAKnownList) {
  std::vector<double> errors;
  for (int i = 100; i >= 0; --i) errors.push_back(i);
  const ErrorStatistics s = error_statistics(errors);
  EXPECT_EQ(s.count, 101);
  EXPECT_DOUBLE_EQ(s.mean, 50);
  EXPECT_DOUBLE_EQ(s.median, 50);
  EXPECT_DOUBLE_EQ(s.percentile_95, 95);
  EXPECT_DOUBLE_EQ(s.maximum, 100);
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt(100 * 201 / 6.0));
}

TEST(Evaluation, MeasuresTheDistanceFromTheTruth) {
  const auto r = raster<2>({20, 10});
  const auto truth = field<2>(r, [](const Point<2>& x) { return Point<2>(1.1 * x); });
  const auto found =
      field<2>(r, [](const Point<2>& x) { return Point<2>(1.1 * x + Vector<2>(3, -4)); });
  EvaluationInput<2> input;
  input.displacement = &found;
  input.truth = &truth;
  const auto e = evaluate(input);
  EXPECT_EQ(e.samples, 200);
  EXPECT_EQ(e.error->count, 200);
  EXPECT_NEAR(e.error->mean, 5, 1e-12);
  EXPECT_NEAR(e.error->median, 5, 1e-12);
  EXPECT_NEAR(e.error->maximum, 5, 1e-12);
  EXPECT_FALSE(e.error_within_3);
  EXPECT_FALSE(e.landmarks);
}

TEST(Evaluation, ReadsATruthOnAnotherRaster) {
  auto coarse = raster<2>({9, 9});
  coarse.spacing = {4, 4};
  coarse.origin = {-2, -1};
  const auto r = raster<2>({20, 20});
  const auto affine = [](const Point<2>& x) {
    return Point<2>(x + Vector<2>(0.1 * x.y() + 1, -0.2 * x.x()));
  };
  const auto truth = field<2>(coarse, affine);
  const auto found = field<2>(r, affine);  // linear interpolation of an affine map is exact
  EvaluationInput<2> input;
  input.displacement = &found;
  input.truth = &truth;
  EXPECT_LT(evaluate(input).error->maximum, 1e-12);
  auto apart = coarse;
  apart.origin = {1000, 0};
  const auto elsewhere = field<2>(apart, affine);
  input.truth = &elsewhere;
  EXPECT_THAT([&] { evaluate(input); }, ThrowsMessage<InvalidInput>(HasSubstr("1000")));
}

TEST(Evaluation, MaskAndLabelsChooseTheSamples) {
  const auto r = raster<2>({64, 10});
  // a border between columns 31 and 32; an error of 1 in the three columns on either side
  const auto labels =
      filled<std::int32_t>(r, [](const Point<2>& x) { return x.x() > 31.5 ? 1 : 0; });
  const auto truth = at_rest(r);
  const auto found = field<2>(r, [](const Point<2>& x) {
    return Point<2>(x + Vector<2>(std::abs(x.x() - 31.5) < 3 ? 1 : 0, 0));
  });
  EvaluationInput<2> input;
  input.displacement = &found;
  input.truth = &truth;
  input.labels = &labels;
  auto e = evaluate(input);
  EXPECT_EQ(e.error_within_3->count, 6 * 10);
  EXPECT_EQ(e.error_within_3->mean, 1);
  EXPECT_EQ(e.error_within_10->count, 20 * 10);
  EXPECT_DOUBLE_EQ(e.error_within_10->mean, 0.3);
  EXPECT_EQ(e.error->count, 640);
  const auto mask = filled<std::uint8_t>(r, [](const Point<2>& x) { return x.y() < 5; });
  input.mask = &mask;
  e = evaluate(input);
  EXPECT_EQ(e.samples, 320);
  EXPECT_EQ(e.error_within_3->count, 6 * 5);
  EXPECT_EQ(e.bodies[0].samples, 32 * 5);
}

TEST(Evaluation, FindsTheRigidMotionOfEachBody) {
  const auto r = raster<2>({60, 60});
  const auto labels = filled<std::int32_t>(r, [](const Point<2>& x) {
    if ((x - Point<2>(15, 15)).norm() < 10) return 3;
    return (x - Point<2>(45, 40)).norm() < 8 ? 7 : 0;
  });
  const auto moved = [](const Point<2>& x, const Point<2>& center, double degrees,
                        const Vector<2>& shift) -> Point<2> {
    return center + shift +
           Eigen::Rotation2D<double>(degrees * std::numbers::pi / 180) * (x - center);
  };
  const auto truth = field<2>(r, [&](const Point<2>& x) {
    return x.x() < 30 ? moved(x, {15, 15}, 12, {2, -1}) : moved(x, {45, 40}, -5, {0, 3});
  });
  const auto found = field<2>(r, [&](const Point<2>& x) {
    return x.x() < 30 ? moved(x, {15, 15}, 10, {2, -0.5}) : moved(x, {45, 40}, -5, {0, 3});
  });
  EvaluationInput<2> input;
  input.displacement = &found;
  input.truth = &truth;
  input.labels = &labels;
  const auto e = evaluate(input);
  ASSERT_EQ(e.bodies.size(), 2u);
  EXPECT_EQ(e.bodies[0].label, 3);
  EXPECT_NEAR(e.bodies[0].angle_deg, 10, 1e-9);
  EXPECT_LT((e.bodies[0].shift_mm - Vector<2>(2, -0.5)).norm(), 1e-9);
  EXPECT_LT(e.bodies[0].rms_nonrigidity_mm, 1e-9);
  EXPECT_NEAR(e.bodies[0].angle_error_deg, 2, 1e-9);
  EXPECT_NEAR(e.bodies[0].shift_error_mm, 0.5, 1e-9);
  EXPECT_EQ(e.bodies[1].label, 7);
  EXPECT_NEAR(e.bodies[1].angle_deg, -5, 1e-9);
  EXPECT_LT(e.bodies[1].error->maximum, 1e-9);
}

// A ripple of amplitude a along x is nearly orthogonal to all rigid motions, so the fit keeps it.
TEST(Evaluation, NonRigidityIsTheDistanceFromTheRigidFit) {
  const auto r = raster<2>({40, 40});
  const LabelImage<2> labels(r, 1);
  const auto found = field<2>(r, [](const Point<2>& x) {
    return Point<2>(x + Vector<2>(static_cast<int>(x.x() + x.y()) % 2 ? 0.3 : -0.3, 5));
  });
  EvaluationInput<2> input;
  input.displacement = &found;
  input.labels = &labels;
  const auto e = evaluate(input);
  EXPECT_NEAR(e.bodies[0].rms_nonrigidity_mm, 0.3, 1e-3);
  EXPECT_NEAR(e.bodies[0].angle_deg, 0, 0.05);
}

TEST(Evaluation, RigidMotionIn3D) {
  auto r = raster<3>({8, 9, 10});
  r.spacing = {1, 2, 1.5};
  const LabelImage<3> labels(r, 1);
  const Eigen::AngleAxisd turn(0.3, Vector<3>(1, 2, -1).normalized());
  const auto found =
      field<3>(r, [&](const Point<3>& x) { return Point<3>(turn * x + Vector<3>(1, 2, 3)); });
  EvaluationInput<3> input;
  input.displacement = &found;
  input.labels = &labels;
  const auto e = evaluate(input);
  EXPECT_NEAR(e.bodies[0].angle_deg, 0.3 * 180 / std::numbers::pi, 1e-9);
  EXPECT_LT(e.bodies[0].rms_nonrigidity_mm, 1e-9);
  EXPECT_NEAR(e.jacobian.minimum, 1, 1e-6);  // single precision map
}

TEST(Evaluation, OverlapOfASquareMovedByTwoPixels) {
  const auto r = raster<2>({40, 40});
  const auto square = [&](double left) {
    return filled<std::int32_t>(r, [left](const Point<2>& x) {
      return x.x() >= left && x.x() < left + 10 && x.y() >= 10 && x.y() < 20 ? 4 : 0;
    });
  };
  const auto fixed = square(10), moving = square(12);
  EvaluationInput<2> input;
  const auto rest = at_rest(r);
  input.displacement = &rest;
  input.labels = &fixed;
  input.moving_labels = &moving;
  auto e = evaluate(input);
  ASSERT_EQ(e.labels.size(), 1u);
  EXPECT_EQ(e.labels[0].label, 4);
  EXPECT_DOUBLE_EQ(e.labels[0].dice, 0.8);
  EXPECT_DOUBLE_EQ(e.labels[0].hausdorff_95_mm, 2);
  const DisplacementField<2> shift(r, Vector<2>(2, 0));
  input.displacement = &shift;
  e = evaluate(input);
  EXPECT_EQ(e.labels[0].dice, 1);
  EXPECT_EQ(e.labels[0].hausdorff_95_mm, 0);
}

TEST(Evaluation, LabelOfOneImageOnlyHasNoDistance) {
  const auto r = raster<2>({10, 10});
  LabelImage<2> fixed(r, 0), moving(r, 0);
  fixed(3, 3) = 1;
  moving(4, 4) = 2;
  const auto rows = compare_labels(fixed, moving);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].dice, 0);
  EXPECT_TRUE(std::isnan(rows[0].hausdorff_95_mm));
}

template <int Dim>
void expect_brute_force_distances(const Raster<Dim>& r, int points) {
  std::mt19937 random(4);
  Mask<Dim> set(r);
  for (int k = 0; k < points; ++k) set.values()[random() % r.num_samples()] = 1;
  const auto distance = distance_to(set);
  for (std::int64_t i = 0; i < r.num_samples(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::int64_t k = 0; k < r.num_samples(); ++k) {
      if (!set.values()[k]) continue;
      const auto a = position<Dim>(r, set.index(i)), b = position<Dim>(r, set.index(k));
      nearest = std::min(nearest, (a - b).norm());
    }
    EXPECT_NEAR(distance.values()[i], nearest, 1e-5);
  }
}

TEST(DistanceTo, EqualsTheSearchOfAllPairs) {
  auto plane = raster<2>({37, 23});
  plane.spacing = {0.7, 1.9};
  expect_brute_force_distances<2>(plane, 6);
  auto volume = raster<3>({9, 12, 7});
  volume.spacing = {1, 0.5, 2.5};
  expect_brute_force_distances<3>(volume, 4);
  EXPECT_TRUE(std::isinf(distance_to(Mask<2>(plane)).values()[0]));
}

TEST(Evaluation, DeterminantOfATurnedRasterIsThatOfTheMap) {
  auto r = raster<2>({30, 20});
  r.spacing = {0.5, 2};
  r.direction = Eigen::Rotation2D<double>(0.4).toRotationMatrix();
  const Matrix<2> a{{1.2, 0.3}, {-0.4, 0.9}};
  const auto found = field<2>(r, [&](const Point<2>& x) { return Point<2>(a * x); });
  EvaluationInput<2> input;
  input.displacement = &found;
  const auto e = evaluate(input);
  EXPECT_NEAR(e.jacobian.minimum, a.determinant(), 1e-6);
  EXPECT_NEAR(e.jacobian.maximum, a.determinant(), 1e-6);
  EXPECT_EQ(e.jacobian.folded, 0);
}

TEST(Evaluation, CountsFoldsAndSaysWhere) {
  const auto r = raster<2>({20, 20});
  const auto found = field<2>(r, [](const Point<2>& x) {
    return Point<2>(x.x() < 14.5 ? x.x() : 29 - x.x(), x.y());  // folded back at x = 14.5
  });
  EvaluationInput<2> input;
  input.displacement = &found;
  const auto e = evaluate(input);
  EXPECT_EQ(e.jacobian.folded, 5 * 20);  // columns 15 to 19
  EXPECT_DOUBLE_EQ(e.jacobian.folded_fraction, 0.25);
  EXPECT_EQ(e.jacobian.minimum, -1);
  EXPECT_GT(e.jacobian.minimum_at.x(), 14.5);
}

TEST(Evaluation, GivenDeterminantsReplaceDifferences) {
  const auto r = raster<2>({4, 4});
  const auto rest = at_rest(r);
  Image<float, 2> determinants(r, 1.0f);
  determinants(2, 1) = -0.25f;
  EvaluationInput<2> input;
  input.displacement = &rest;
  input.determinants = &determinants;
  const auto e = evaluate(input);
  EXPECT_EQ(e.jacobian.minimum, -0.25);
  EXPECT_EQ(e.jacobian.minimum_at, Point<2>(2, 1));
  EXPECT_EQ(e.jacobian.folded, 1);
}

TEST(Evaluation, LandmarksAreJudgedByTheMapItself) {
  const auto r = raster<2>({10, 10});
  const auto rest = at_rest(r);
  EvaluationInput<2> input;
  input.displacement = &rest;
  input.landmarks.fixed = {{1, 1}, {9.5, 9.5}};
  input.landmarks.moving = {{4, 5}, {9.5, 9.5}};
  auto e = evaluate(input);
  EXPECT_NEAR(e.landmark_errors_mm[0], 5, 1e-12);
  EXPECT_NEAR(e.landmark_errors_mm[1], 0, 1e-12);
  EXPECT_NEAR(e.landmarks->mean, 2.5, 1e-12);
  input.map = [](const Point<2>& x) { return Point<2>(x + Vector<2>(3, 4)); };
  e = evaluate(input);
  EXPECT_NEAR(e.landmark_errors_mm[0], 0, 1e-12);
  input.map = nullptr;
  input.landmarks.fixed[1] = {30, 2};
  EXPECT_THAT([&] { evaluate(input); },
              ThrowsMessage<InvalidInput>(AllOf(HasSubstr("landmark 2"), HasSubstr("30"))));
}

TEST(Evaluation, MatchOfAShiftedImage) {
  const auto r = raster<2>({50, 40});
  const auto wave = [](const Point<2>& x) {
    return static_cast<float>(std::sin(0.3 * x.x()) + std::cos(0.2 * x.y() + 0.1 * x.x()));
  };
  const auto moving = filled<float>(r, wave);
  const auto fixed =
      filled<float>(r, [&](const Point<2>& x) { return wave(x + Vector<2>(3, -2)); });
  const DisplacementField<2> shift(r, Vector<2>(3, -2));
  EvaluationInput<2> input;
  input.displacement = &shift;
  input.fixed = &fixed;
  input.moving = &moving;
  auto e = evaluate(input);
  EXPECT_EQ(e.match->samples, 47 * 38);  // those that stay inside
  EXPECT_GT(e.match->ssd_reduction_percent, 99.999);
  EXPECT_NEAR(e.match->ncc_after, 1, 1e-5);
  EXPECT_LT(e.match->ncc_before, 0.9);
  const auto rest = at_rest(r);
  input.displacement = &rest;
  e = evaluate(input);
  EXPECT_NEAR(e.match->ssd_before, e.match->ssd_after, 1e-6 * e.match->ssd_before);
  EXPECT_NEAR(e.match->ssd_reduction_percent, 0, 1e-4);  // single precision
}

TEST(Evaluation, RefusesFieldsThatAreNotFinite) {
  const auto r = raster<2>({10, 10});
  auto found = at_rest(r);
  found(7, 2).x() = std::nan("");
  found(3, 5).y() = std::numeric_limits<double>::infinity();
  EvaluationInput<2> input;
  input.displacement = &found;
  EXPECT_THAT([&] { evaluate(input); },
              ThrowsMessage<InvalidInput>(AllOf(HasSubstr("2 sample"), HasSubstr("(7, 2)"))));
  const auto mask = filled<std::uint8_t>(r, [](const Point<2>& x) { return x.y() > 5.5; });
  input.mask = &mask;
  EXPECT_EQ(evaluate(input).samples, 40);
  const Mask<2> nothing(r, 0);
  input.mask = &nothing;
  EXPECT_THAT([&] { evaluate(input); }, ThrowsMessage<InvalidInput>(HasSubstr("mask")));
  EXPECT_THAT([] { evaluate(EvaluationInput<2>{}); },
              ThrowsMessage<InvalidInput>(HasSubstr("no displacement")));
}

}  // namespace
}  // namespace crease

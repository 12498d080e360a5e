// Registrations that fold unless asked not to.
#include "Registration/Unfolding.h"

#include <gtest/gtest.h>

#include "Registration/Registration.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/JacobianMap.h"

namespace crease {
namespace {

/// Two landmarks that come close to each other, from a quarter of the side to a hundredth, between others at
/// rest.
template <int Dim>
Landmarks<Dim> squeezed(const Box<Dim>& box, double distance) {
  const double side = box.size()[0];
  const Point<Dim> centre = 0.5 * (box.lower + box.upper);
  Landmarks<Dim> landmarks;
  for (int sign : {-1, 1}) {
    Point<Dim> fixed = centre, moving = centre;
    fixed[0] += sign * 0.125 * side;
    moving[0] += sign * 0.5 * distance * side;
    landmarks.fixed.push_back(fixed);
    landmarks.moving.push_back(moving);
    fixed[0] = centre[0] + sign * 0.3 * side;
    landmarks.fixed.push_back(fixed);
    landmarks.moving.push_back(fixed);
  }
  return landmarks;
}

template <int Dim>
RegistrationResult<Dim> by_landmarks(const std::shared_ptr<const SplineBasis<Dim>>& basis,
                                     const Landmarks<Dim>& landmarks, bool invertible) {
  Schedule schedule;
  schedule.require_invertible = invertible;
  Registration<Dim> registration;
  registration.basis(basis).landmarks(landmarks).schedule(schedule);
  registration.energy("bending", 1, bending<Dim>());
  return registration.run();
}

template <int Dim>
Box<Dim> box_of(double side) {
  Box<Dim> box;
  box.add(Point<Dim>::Zero());
  box.add(Point<Dim>::Constant(side));
  return box;
}

template <int Dim>
void expect_unfolds_landmarks(const std::shared_ptr<const SplineBasis<Dim>>& basis,
                              double distance) {
  const Box<Dim> box = basis->bounds();
  const auto landmarks = squeezed<Dim>(box, distance);
  const auto folded = by_landmarks<Dim>(basis, landmarks, false);
  ASSERT_EQ(certify_invertibility(*folded.transform).verdict, Invertibility::kFolded);
  EXPECT_FALSE(folded.unfolding.has_value());

  const auto result = by_landmarks<Dim>(basis, landmarks, true);
  ASSERT_TRUE(result.unfolding.has_value());
  EXPECT_TRUE(result.unfolding->certified);
  EXPECT_GT(result.unfolding->rounds, 0);
  const auto certificate = certify_invertibility(*result.transform);
  EXPECT_TRUE(certificate.certified());
  EXPECT_GT(certificate.lower_bound, 0);
  for (double error : result.landmark_errors_mm) EXPECT_LT(error, 1e-9);
  Raster<Dim> fine;
  fine.size.fill(Dim == 2 ? 200 : 50);
  fine.spacing = box.size() / fine.size[0];
  fine.origin = box.lower + 0.5 * fine.spacing;
  EXPECT_EQ(jacobian_map<Dim>(*result.transform, fine).statistics().num_folded, 0);
}

/// Images with a motion that the spline follows into the noise, for want of bending.
Registration<2> overfitted(const std::shared_ptr<const SplineBasis<2>>& basis, bool invertible) {
  const auto raster = testing::raster_of<2>(64);
  auto fixed = testing::scene_image<2>(raster);
  auto moving = testing::image_of<2>(raster, [](const Point<2>& x) {
    return Point<2>(x[0] + 3 * std::sin(0.1 * x[1]), x[1] + 3 * std::cos(0.12 * x[0]));
  });
  testing::Numbers numbers(3);
  for (float& v : fixed.values()) v += static_cast<float>(0.3 * numbers());
  for (float& v : moving.values()) v += static_cast<float>(0.3 * numbers());
  Schedule schedule;
  schedule.require_invertible = invertible;
  Registration<2> registration(fixed, moving);
  registration.initial({}).basis(basis).energy("bending", 2e-3, bending<2>()).schedule(schedule);
  return registration;
}

}  // namespace

TEST(Unfolding, LandmarksThatFoldATensorProduct) {
  expect_unfolds_landmarks<2>(testing::tensor_over<2>(box_of<2>(60), 8, 3), 0.01);
}

TEST(Unfolding, LandmarksThatFoldTriangles) {
  expect_unfolds_landmarks<2>(testing::triangles_over(box_of<2>(60), {.degree = 3}, 8), 0.01);
}

TEST(Unfolding, LandmarksThatFoldASpace) {
  expect_unfolds_landmarks<3>(testing::tensor_over<3>(box_of<3>(60), 5, 3), 0.03);
}

// Landmarks on a line that change sides: every smooth map that meets them folds in between, or turns them
// round; the way of least energy folds. Whatever comes out is not called certified unless it is.
TEST(Unfolding, IsHonestAboutLandmarksThatChangeSides) {
  const auto basis = testing::tensor_over<2>(box_of<2>(60), 4, 3);
  const auto result = by_landmarks<2>(basis, squeezed<2>(basis->bounds(), -0.2), true);
  ASSERT_TRUE(result.unfolding.has_value());
  const bool certified = certify_invertibility(*result.transform).certified();
  EXPECT_EQ(result.unfolding->certified, certified);
  for (double error : result.landmark_errors_mm) EXPECT_LT(error, 1e-9);
}

TEST(Unfolding, LeavesMapsThatDoNotFoldAsTheyAre) {
  const auto basis = testing::triangles_over(box_of<2>(60), {.degree = 3});
  const auto landmarks = squeezed<2>(basis->bounds(), 0.22);
  const auto as_it_is = by_landmarks<2>(basis, landmarks, false);
  const auto asked = by_landmarks<2>(basis, landmarks, true);
  EXPECT_FALSE(asked.unfolding.has_value());
  EXPECT_EQ(asked.transform->parameters(), as_it_is.transform->parameters());
}

TEST(Unfolding, ImagesKeepTheirMatch) {
  const auto box = testing::raster_of<2>(64).bounds();
  for (const auto& basis : {testing::tensor_over<2>(box, 10, 3), testing::creased_over(box)}) {
    const auto folded = overfitted(basis, false).run();
    ASSERT_EQ(certify_invertibility(*folded.transform).verdict, Invertibility::kFolded);
    const auto result = overfitted(basis, true).run();
    ASSERT_TRUE(result.unfolding.has_value());
    EXPECT_TRUE(certify_invertibility(*result.transform).certified());
    EXPECT_DOUBLE_EQ(result.unfolding->folded_metric, folded.metric_after);
    EXPECT_LT(result.metric_after, 1.2 * folded.metric_after);
    EXPECT_EQ(result.unfolding->share, 1);
  }
}

}  // namespace crease

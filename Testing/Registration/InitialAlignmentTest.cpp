#include "Registration/InitialAlignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "Core/Error.h"
#include "Testing/Registration/TestScenes.h"

namespace crease {
namespace {

Matrix<2> turn(double degrees) {
  return Eigen::Rotation2Dd(degrees * std::numbers::pi / 180).toRotationMatrix();
}

template <int Dim>
Alignment<Dim> align_to(const AffineMap<Dim>& truth, AlignmentSearch search, int size) {
  const auto raster = testing::raster_of<Dim>(size);
  const auto fixed = testing::image_of<Dim>(raster, truth);
  const auto moving = testing::scene_image<Dim>(raster);
  return align<Dim>(fixed, moving, nullptr, nullptr, {},
                    {.start = AlignmentStart::kCentres, .search = search});
}

}  // namespace

TEST(InitialAlignment, FindsATranslationToAHundredthOfAPixel) {
  const auto raster = testing::raster_of<2>(160);
  const auto truth = testing::about_centre<2>(raster, Matrix<2>::Identity(), {3.0, -2.4});
  const auto found = align_to<2>(truth, AlignmentSearch::kRigid, 160);
  EXPECT_LT(testing::rms_difference(raster, found.map, truth, 0), 0.02);
  EXPECT_LT(found.report.metric_after, 0.01 * found.report.metric_before);
}

TEST(InitialAlignment, FindsARotationOfTenDegrees) {
  const auto raster = testing::raster_of<2>(160);
  const auto truth = testing::about_centre<2>(raster, turn(10), {2, 1});
  const auto found = align_to<2>(truth, AlignmentSearch::kRigid, 160);
  EXPECT_LT(testing::rms_difference(raster, found.map, truth, 0), 0.02);
  EXPECT_NEAR(found.report.angle_deg, 10, 0.02);
}

TEST(InitialAlignment, FindsAnAffineMap) {
  const auto raster = testing::raster_of<2>(160);
  const auto truth =
      testing::about_centre<2>(raster, Matrix<2>{{1.04, 0.05}, {-0.02, 0.97}}, {2, -1});
  const auto found = align_to<2>(truth, AlignmentSearch::kAffine, 160);
  EXPECT_LT(testing::rms_difference(raster, found.map, truth, 0), 0.02);
}

TEST(InitialAlignment, FindsASimilarity) {
  const auto raster = testing::raster_of<2>(160);
  const auto truth = testing::about_centre<2>(raster, 1.06 * turn(-7), {2, -1});
  const auto found = align_to<2>(truth, AlignmentSearch::kSimilarity, 160);
  EXPECT_LT(testing::rms_difference(raster, found.map, truth, 0), 0.02);
  const Matrix<2> square = found.map.linear.transpose() * found.map.linear;
  EXPECT_LT((square - square(0, 0) * Matrix<2>::Identity()).norm(), 1e-12);  // no shear
}

TEST(InitialAlignment, FindsASimilarityInSpace) {
  const auto raster = testing::raster_of<3>(40);
  const Matrix<3> rotation =
      Eigen::AngleAxisd(0.08, Vector<3>(1, 2, 3).normalized()).toRotationMatrix();
  const auto truth = testing::about_centre<3>(raster, 0.95 * rotation, {1.0, -0.6, 0.4});
  const auto found = align_to<3>(truth, AlignmentSearch::kSimilarity, 40);
  EXPECT_LT(testing::rms_difference(raster, found.map, truth, 0), 0.02);
}

TEST(InitialAlignment, FindsARigidMotionInSpace) {
  const auto raster = testing::raster_of<3>(40);
  const Matrix<3> rotation =
      Eigen::AngleAxisd(0.08, Vector<3>(1, 2, 3).normalized()).toRotationMatrix();
  const auto truth = testing::about_centre<3>(raster, rotation, {1.0, -0.6, 0.4});
  const auto found = align_to<3>(truth, AlignmentSearch::kRigid, 40);
  EXPECT_LT(testing::rms_difference(raster, found.map, truth, 0), 0.02);
}

TEST(InitialAlignment, FindsAnAffineMapInSpace) {
  const auto raster = testing::raster_of<3>(40);
  Matrix<3> linear = Matrix<3>::Identity();
  linear(0, 1) = 0.04;
  linear(2, 2) = 0.96;
  const auto truth = testing::about_centre<3>(raster, linear, {0.5, -0.6, 0.4});
  const auto found = align_to<3>(truth, AlignmentSearch::kAffine, 40);
  EXPECT_LT(testing::rms_difference(raster, found.map, truth, 0), 0.02);
}

TEST(InitialAlignment, LeavesIdenticalImagesAlone) {
  const auto raster = testing::raster_of<2>(96);
  const auto image = testing::scene_image<2>(raster);
  for (auto search : {AlignmentSearch::kNone, AlignmentSearch::kRigid, AlignmentSearch::kSimilarity,
                      AlignmentSearch::kAffine}) {
    for (auto start : {AlignmentStart::kMoments, AlignmentStart::kCentres}) {
      const auto found =
          align<2>(image, image, nullptr, nullptr, {}, {.start = start, .search = search});
      EXPECT_LT(testing::rms_difference(raster, found.map, AffineMap<2>(), 0), 1e-6);
    }
  }
}

TEST(InitialAlignment, StartsFromTheLandmarksFit) {
  const auto raster = testing::raster_of<2>(64);
  const auto truth = testing::about_centre<2>(raster, turn(70), {5, 3});
  const auto image = testing::scene_image<2>(raster);
  Landmarks<2> landmarks;
  landmarks.fixed = {{10, 10}, {50, 12}, {30, 40}};
  for (const auto& p : landmarks.fixed) landmarks.moving.push_back(truth(p));
  const auto found =
      align<2>(image, image, nullptr, nullptr, landmarks, {.start = AlignmentStart::kLandmarks});
  EXPECT_LT(testing::rms_difference(raster, found.map, truth, 0), 1e-9);
}

TEST(InitialAlignment, StartsFromTheLandmarksSimilarity) {
  const auto raster = testing::raster_of<2>(64);
  const auto truth = testing::about_centre<2>(raster, 1.3 * turn(70), {5, 3});
  const auto fixed = testing::image_of<2>(raster, truth);
  const auto moving = testing::scene_image<2>(raster);
  Landmarks<2> landmarks;
  landmarks.fixed = {{10, 10}, {50, 12}};
  for (const auto& p : landmarks.fixed) landmarks.moving.push_back(truth(p));
  const auto found =
      align<2>(fixed, moving, nullptr, nullptr, landmarks,
               {.start = AlignmentStart::kLandmarks, .search = AlignmentSearch::kSimilarity});
  EXPECT_LT(testing::rms_difference(raster, found.map, truth, 0), 0.02);
}

TEST(InitialAlignment, NamesBothBoxesOfImagesThatDoNotOverlap) {
  auto raster = testing::raster_of<2>(32);
  const auto fixed = testing::scene_image<2>(raster);
  raster.origin = {5000, 0};
  const auto moving = testing::scene_image<2>(raster);
  EXPECT_THAT(([&] {
                align<2>(fixed, moving, nullptr, nullptr, {}, {.start = AlignmentStart::kIdentity});
              }),
              ::testing::ThrowsMessage<InvalidInput>(
                  ::testing::AllOf(::testing::HasSubstr("do not overlap"),
                                   ::testing::HasSubstr("4999.5"), ::testing::HasSubstr("31.5"))));
}

}  // namespace crease

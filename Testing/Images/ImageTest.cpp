#include "Images/Image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "Core/Error.h"
#include "Images/OpenCvView.h"
#include "Images/RasterCheck.h"
#include "Testing/Images/TestImages.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::plain_raster;
using ::testing::ThrowsMessage;
using testing::turned_raster;

TEST(Image, StoresTheFirstIndexFastest) {
  Image<float, 3> image(plain_raster<3>({4, 3, 2}));
  image(1, 2, 1) = 7;
  EXPECT_EQ(image.values()[1 + 4 * (2 + 3 * 1)], 7);
  EXPECT_EQ(image.offset({1, 2, 1}), 21u);
  EXPECT_EQ(image.index(21), (std::array{1, 2, 1}));
  EXPECT_EQ(image.row(5)[1], 7);
  EXPECT_EQ((image[{1, 2, 1}]), 7);
}

TEST(Image, MovesToAnotherRasterWithoutCopying) {
  Image<float, 2> image(plain_raster<2>({4, 3}));
  const float* pixels = image.values().data();
  const Image<float, 2> moved(turned_raster<2>({4, 3}), std::move(image).take_values());
  EXPECT_EQ(moved.values().data(), pixels);
  EXPECT_EQ(moved.raster().spacing, turned_raster<2>({4, 3}).spacing);
  const auto make_mismatch = [&] {
    return Image<float, 2>(plain_raster<2>({5, 3}), moved.values());
  };
  EXPECT_THAT(make_mismatch,
              ThrowsMessage<InvalidInput>(HasSubstr("12 values for a raster of 15 samples")));
}

TEST(Image, FieldsBeginAtZero) {
  const DisplacementField<3> field(plain_raster<3>({2, 2, 2}));
  for (const auto& u : field.values()) EXPECT_EQ(u.norm(), 0);
}

TEST(OpenCvView, SharesThePixels) {
  Image<float, 2> image(plain_raster<2>({4, 3}));
  cv::Mat view = opencv_view(image);
  EXPECT_EQ(view.rows, 3);
  EXPECT_EQ(view.cols, 4);
  view.at<float>(2, 1) = 5;
  EXPECT_EQ(image(1, 2), 5);
  DisplacementField<2> field(image.raster());
  opencv_view(field).at<cv::Vec2d>(1, 3) = cv::Vec2d(2, -3);
  EXPECT_EQ(field(3, 1), Vector<2>(2, -3));
  const auto& constant = image;
  EXPECT_EQ(cv::sum(opencv_view(constant))[0], 5);
}

TEST(RasterCheck, NamesWhatIsWrong) {
  const auto expect_refused = [](auto&& change, const char* reason) {
    Raster<2> raster = turned_raster<2>({4, 3});
    change(raster);
    EXPECT_THAT(
        [&] { check_raster(raster, "fixed image"); },
        ThrowsMessage<InvalidInput>(::testing::AllOf(HasSubstr("fixed image"), HasSubstr(reason))));
  };
  EXPECT_NO_THROW(check_raster(turned_raster<3>({4, 3, 2}), "fixed image"));
  expect_refused([](auto& r) { r.size[1] = 0; }, "4 x 0");
  expect_refused([](auto& r) { r.spacing[0] = 0; }, "spacing");
  expect_refused([](auto& r) { r.spacing[1] = -1; }, "spacing");
  expect_refused([](auto& r) { r.origin[1] = std::nan(""); }, "origin");
  expect_refused([](auto& r) { r.direction(0, 1) += 0.01; }, "orthogonal");
}

TEST(RasterCheck, TellsWhetherSamplesAreTheSame) {
  const auto raster = turned_raster<3>({40, 30, 20});
  auto other = raster;
  EXPECT_TRUE(same_raster(raster, other));
  other.origin[2] += 1e-5;
  EXPECT_TRUE(same_raster(raster, other));
  other.spacing[2] += 1e-3;  // 19 times that at the far end
  EXPECT_FALSE(same_raster(raster, other));
  other = raster;
  other.size[0] = 41;
  EXPECT_FALSE(same_raster(raster, other));
}

}  // namespace
}  // namespace crease

#include <gtest/gtest.h>

#include <filesystem>

#include "Images/ImageFile.h"
#include "Registration/Mammogram/ContourPairs.h"
#include "Registration/Mammogram/MammogramAnatomy.h"
#include "Testing/Registration/Mammogram/DrawnBreast.h"

namespace crease {
namespace {

/// Films of the mini-MIAS database with masks drawn by hand, where they are at hand.
class Mias : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::filesystem::path folder =
        std::filesystem::path(CREASE_SHARED_DIR) / "data" / "mammograms";
    const auto film = folder / (std::string(GetParam()) + ".png");
    const auto mask = folder / (std::string(GetParam()) + "_breastmask.png");
    if (!std::filesystem::exists(film) || !std::filesystem::exists(mask)) {
      GTEST_SKIP() << film << " is not there";
    }
    const Image<float, 2> read = read_image<2>(film).image;
    Raster<2> raster = read.raster();
    raster.spacing.setConstant(0.2);  // of the database; the files do not say it
    image_ = {raster, read.values()};
    mask_ = read_mask<2>(mask);
  }
  Image<float, 2> image_;
  Mask<2> mask_;
};

TEST_P(Mias, SegmentationAgreesWithTheHandMask) {
  const MammogramAnatomy anatomy = analyse_mammogram(image_);
  const Mask<2> truth = mask_in_frame(mask_, anatomy.frame);
  EXPECT_GE(testing::dice(anatomy.breast.mask, truth), 0.985);
  ASSERT_TRUE(anatomy.breast.histogram.valley.has_value());
  EXPECT_GT(*anatomy.breast.histogram.valley, 4);
  EXPECT_LT(*anatomy.breast.histogram.valley, 14);
}

TEST_P(Mias, BitDepthInversionAndSideDoNotMatter) {
  const MammogramAnatomy plain = analyse_mammogram(image_);
  auto deep = image_;
  for (float& v : deep.values()) v *= 257;
  auto shallow = image_;
  for (float& v : shallow.values()) v *= 16;
  for (const auto& image : {deep, shallow, testing::negative(image_, 255)}) {
    EXPECT_GE(testing::dice(analyse_mammogram(image).breast.mask, plain.breast.mask), 0.998);
  }
  const MammogramAnatomy turned = analyse_mammogram(testing::flipped(image_));
  EXPECT_GE(testing::dice(testing::flipped(turned.breast.mask), plain.breast.mask), 0.998);
  EXPECT_NE(turned.breast.side, plain.breast.side);
}

TEST_P(Mias, ObliqueViewsShowThePectoralMuscle) {
  const MammogramAnatomy anatomy = analyse_mammogram(image_);
  ASSERT_TRUE(anatomy.pectoral.has_value());
  EXPECT_GT(polyline_length(anatomy.pectoral->line, false), 40);
  EXPECT_FALSE(find_self_intersection(anatomy.region, true).has_value());
}

INSTANTIATE_TEST_SUITE_P(Films, Mias, ::testing::Values("mdb015", "mdb016"));

}  // namespace
}  // namespace crease

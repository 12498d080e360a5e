#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Images/ImageFile.h"
#include "Images/IntensityRange.h"
#include "Testing/Images/TestFiles.h"

// Files of other programs, with the facts that come with them.
namespace crease {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::read_text;
using testing::shared_file;
using testing::TemporaryFolder;

TEST(RealImageFile, FourEncodingsOfOneImageGiveEqualPixels) {
  CREASE_NEEDS("readers/MR_small.dcm");
  const auto expected = read_image<2>(shared_file("readers/MR_small.dcm"));
  EXPECT_EQ(expected.image.size(), (std::array{64, 64}));
  EXPECT_EQ(intensity_range(expected.image).lower, 127);
  EXPECT_EQ(intensity_range(expected.image).upper, 2145);
  EXPECT_EQ(expected.pixel_type, PixelType::kInt16);
  for (const char* name : {"implicit", "bigendian", "RLE"}) {
    const auto read = read_image<2>(shared_file(std::string("readers/MR_small_") + name + ".dcm"));
    EXPECT_EQ(read.image.values(), expected.image.values()) << name;
    EXPECT_EQ(read.image.raster().origin, expected.image.raster().origin) << name;
    EXPECT_EQ(read.image.raster().spacing, Vector<2>(0.3125, 0.3125)) << name;
  }
}

TEST(RealImageFile, DicomSlopeAndInterceptAreApplied) {
  CREASE_NEEDS("readers/CT_small.dcm");
  const auto ct = read_image_info(shared_file("readers/CT_small.dcm"));
  EXPECT_EQ(ct.minimum, 128 - 1024);
  EXPECT_EQ(ct.maximum, 2191 - 1024);
  EXPECT_EQ(ct.header.size, (std::array{128, 128, 1}));
}

// Stored 1994 .. 2802 of 12 bits: turned round that is 4095 - 2802 .. 4095 - 1994.
TEST(RealImageFile, Monochrome1IsTurnedRoundAndSaid) {
  CREASE_NEEDS("readers/CR_mono1_12bit_6154.dcm");
  const auto cr = read_image_info(shared_file("readers/CR_mono1_12bit_6154.dcm"));
  EXPECT_NEAR(cr.minimum, 0.684 * (4095 - 2802) + 200, 0.5);
  EXPECT_NEAR(cr.maximum, 0.684 * (4095 - 1994) + 200, 0.5);
  EXPECT_THAT(cr.header.notes, Contains(HasSubstr("MONOCHROME1")));
}

TEST(RealImageFile, MultiFrameDicomIs3D) {
  CREASE_NEEDS("readers/rtdose.dcm");
  const auto dose = read_image<3>(shared_file("readers/rtdose.dcm"));
  EXPECT_EQ(dose.image.size(), (std::array{10, 10, 15}));
  EXPECT_EQ(intensity_range(dose.image).lower, 795000);
  EXPECT_EQ(intensity_range(dose.image).upper, 1254000);
  const auto mr = read_image_info(shared_file("readers/emri_small.dcm"));
  EXPECT_EQ(mr.header.size, (std::array{64, 64, 10}));
  EXPECT_EQ(mr.maximum, 467);
  EXPECT_THAT(mr.header.notes, Contains(HasSubstr("1 mm is assumed")));
}

TEST(RealImageFile, Volumes) {
  CREASE_NEEDS("readers/anatomical.nii");
  const auto nifti = read_image_info(shared_file("readers/anatomical.nii")).header;
  EXPECT_EQ(nifti.size, (std::array{33, 41, 25}));
  EXPECT_EQ(nifti.spacing, Vector<3>(2, 2, 2));
  EXPECT_EQ(nifti.pixel_type, PixelType::kInt16);
  const auto meta = read_image_info(shared_file("readers/neghip.mha"));
  EXPECT_EQ(meta.header.size, (std::array{70, 70, 70}));
  EXPECT_EQ(meta.maximum, 255);
}

TEST(RealImageFile, Slices) {
  CREASE_NEEDS("images2d/r16slice.nii.gz");
  const auto brain = read_image_info(shared_file("images2d/r16slice.nii.gz"));
  EXPECT_EQ(brain.header.size, (std::array{256, 256, 1}));
  EXPECT_NEAR(brain.maximum, 183.5, 0.05);
  const auto head = read_image_info(shared_file("images2d/elastix2d/fixed.mhd"));
  EXPECT_EQ(head.minimum, -2);
  EXPECT_EQ(head.maximum, 217);
  const auto mask = read_mask<2>(shared_file("images2d/elastix2d/mask_fixed.mhd"));
  EXPECT_THAT(mask.values(), Contains(1));
  const auto hand = read_image_info(shared_file("landmarks/hands/hands-R.jpg")).header;
  EXPECT_EQ(hand.size, (std::array{128, 128, 1}));
  const auto lung = read_image_info(shared_file("landmarks/lung_lobes/1-he.png")).header;
  EXPECT_EQ(lung.size, (std::array{400, 800, 1}));
  EXPECT_EQ(lung.pixel_type, PixelType::kUint16);
}

// The palette of these files is grey, so that nothing is lost; one is the other moved by (13, 17).
TEST(RealImageFile, GreyPalettesAreGreyValues) {
  CREASE_NEEDS("images2d/BrainProtonDensitySliceBorder20.png");
  const auto a = read_image<2>(shared_file("images2d/BrainProtonDensitySliceBorder20.png"));
  const auto b = read_image<2>(shared_file("images2d/BrainProtonDensitySliceShifted13x17y.png"));
  EXPECT_EQ(a.image.size(), (std::array{221, 257}));
  EXPECT_EQ(a.pixel_type, PixelType::kUint8);
  EXPECT_THAT(a.notes, IsEmpty());
  int different = 0;
  for (int j = 60; j < 200; ++j) {
    for (int i = 60; i < 160; ++i) different += a.image(i, j) != b.image(i + 13, j + 17);
  }
  EXPECT_EQ(different, 0);
}

TEST(RealImageFile, OneBitMasks) {
  CREASE_NEEDS("mammograms/mdb015_breastmask.png");
  const auto mask = read_mask<2>(shared_file("mammograms/mdb015_breastmask.png"));
  EXPECT_EQ(std::ranges::count(mask.values(), 1), 304029);
}

// What an input file says about a patient must not be in any output.
TEST(RealImageFile, NothingOfAHeaderButItsGeometryReachesAnOutput) {
  CREASE_NEEDS("readers/CT_small.dcm");
  const TemporaryFolder folder;
  const std::string input = read_text(shared_file("readers/CT_small.dcm"));
  const std::vector<std::string> tags{"CompressedSamples", "1CT1",       "2004",
                                      "JFK IMAGING",       "GE MEDICAL", "1.3.6.1.4.1.5962"};
  for (const auto& tag : tags) ASSERT_THAT(input, HasSubstr(tag));
  const auto read = read_image<2>(shared_file("readers/CT_small.dcm"));
  DisplacementField<2> field(read.image.raster());
  write_displacement_field(folder / "field.mha", field);
  write_labels(folder / "labels.nii.gz", LabelImage<2>(read.image.raster()));
  write_image(folder / "image.mha", read.image, PixelType::kInt16);
  write_image(folder / "image.nii", read.image, PixelType::kInt16);
  write_image(folder / "image.nrrd", read.image, PixelType::kInt16);
  write_image(folder / "image.tif", read.image, PixelType::kInt16);
  write_image(folder / "image.png", read.image, PixelType::kUint16);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string output = read_text(entry.path());
    for (const auto& tag : tags) {
      EXPECT_THAT(output, Not(HasSubstr(tag))) << entry.path();
    }
    ++files;
  }
  EXPECT_EQ(files, 7);
}

}  // namespace
}  // namespace crease

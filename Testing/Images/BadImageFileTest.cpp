#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Images/ImageFile.h"
#include "Testing/Images/TestFiles.h"
#include "Testing/Images/TestImages.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::read_text;
using testing::shared_file;
using testing::TemporaryFolder;
using ::testing::ThrowsMessage;
using testing::write_text;

void expect_refused(const std::filesystem::path& path, const std::string& reason) {
  EXPECT_THAT(
      [&] { read_image_info(path); },
      ThrowsMessage<FileError>(AllOf(HasSubstr(path.filename().string()), HasSubstr(reason))))
      << path;
}

TEST(BadImageFile, MissingEmptyAndFolder) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.jpg", "a.tif", "a.pgm", "a.dcm", "a.nii", "a.nii.gz",
                           "a.mha", "a.mhd", "a.nrrd"}) {
    expect_refused(folder / name, "there is no such file");
    write_text(folder / name, "");
    expect_refused(folder / name, "the file is empty");
    std::filesystem::remove(folder / name);
    std::filesystem::create_directory(folder / name);
    expect_refused(folder / name, "this is a folder");
  }
}

TEST(BadImageFile, FilesThatAreNotWhatTheirNameSays) {
  const TemporaryFolder folder;
  for (const char* name :
       {"a.png", "a.jpg", "a.tif", "a.pgm", "a.dcm", "a.nii", "a.nii.gz", "a.mha", "a.nrrd"}) {
    write_text(folder / name, "Dear reader, this is a letter and no image at all.\n");
    expect_refused(folder / name, "this is not");
  }
}

// A file may be cut anywhere. Readers of other libraries return what they found, or end the process.
TEST(BadImageFile, TruncatedAnywhere) {
  const TemporaryFolder folder;
  const auto image = testing::noise_image(testing::turned_raster<2>({24, 20}));
  Image<float, 2> bytes = image;
  for (float& v : bytes.values()) v = std::round(255 * v);
  for (const char* name :
       {"a.png", "a.jpg", "a.tif", "a.pgm", "a.nii", "a.nii.gz", "a.mha", "a.nrrd"}) {
    write_image(folder / name, bytes, PixelType::kUint8);
    const std::string whole = read_text(folder / name);
    for (std::size_t length = 1; length < whole.size(); length += 1 + whole.size() / 97) {
      write_text(folder / name, whole.substr(0, length));
      EXPECT_THROW(read_image_info(folder / name), FileError) << name << " cut to " << length;
    }
    write_text(folder / name, whole.substr(0, whole.size() - 1));
    EXPECT_THROW(read_image_info(folder / name), FileError) << name << " without its last byte";
  }
}

TEST(BadImageFile, MetaImageWithTooFewPixels) {
  const TemporaryFolder folder;
  write_image(folder / "a.mhd", testing::noise_image(testing::plain_raster<2>({24, 20})),
              PixelType::kFloat);
  const std::string pixels = read_text(folder / "a.raw");
  write_text(folder / "a.raw", pixels.substr(0, 1900));
  EXPECT_THAT([&] { read_image_info(folder / "a.mhd"); },
              ThrowsMessage<FileError>(HasSubstr("needs 1920 bytes and has 1900")));
  write_text(folder / "a.raw", pixels + "twelve more.");  // harmless, and seen in public data
  EXPECT_NO_THROW(read_image_info(folder / "a.mhd"));
  std::filesystem::remove(folder / "a.raw");
  expect_refused(folder / "a.mhd", "are missing");
}

// ITK would read two of the four values and leave the others as they are in memory.
TEST(BadImageFile, MetaImageWithVectorsAsText) {
  const TemporaryFolder folder;
  const std::string start = "ObjectType = Image\nNDims = 2\nBinaryData = False\nDimSize = 2 1\n";
  const std::string end = "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n1 2 3 4\n";
  write_text(folder / "a.mha", start + "ElementNumberOfChannels = 2\n" + end);
  expect_refused(folder / "a.mha", "written as text");
  write_text(folder / "a.mha", start + end);
  EXPECT_EQ(read_image<2>(folder / "a.mha").image.values(), (std::vector<float>{1, 2}));
}

TEST(BadImageFile, SpacingAndDirectionThatMakeNoSense) {
  const TemporaryFolder folder;
  const std::string start = "ObjectType = Image\nNDims = 2\nBinaryData = True\nDimSize = 2 1\n";
  const std::string end = "ElementType = MET_UCHAR\nElementDataFile = LOCAL\nab";
  write_text(folder / "a.mha", start + "ElementSpacing = 1 0\n" + end);
  expect_refused(folder / "a.mha", "spacing");
  write_text(folder / "a.mha", start + "ElementSpacing = 1 -2\n" + end);
  expect_refused(folder / "a.mha", "spacing");
  write_text(folder / "a.mha", start + "TransformMatrix = 1 0 0.5 0.8\n" + end);
  expect_refused(folder / "a.mha", "right angles");
  write_text(folder / "a.mha", start + "ElementSpacing = 1 2\n" + end);
  EXPECT_NO_THROW(read_image_info(folder / "a.mha"));
}

TEST(BadImageFile, SizesThatMakeNoSense) {
  const TemporaryFolder folder;
  for (const char* size : {"0 5", "-3 5", "5", "5 5 5", "99999999 99999999", "x y"}) {
    write_text(folder / "a.mha", std::string("ObjectType = Image\nNDims = 2\nDimSize = ") + size +
                                     "\nElementType = MET_UCHAR\nElementDataFile = LOCAL\nabcdef");
    EXPECT_THROW(read_image_info(folder / "a.mha"), FileError) << size;
  }
  for (const char* header :
       {"P5 0 4 255\n", "P5 4 4 0\n", "P5 4 4 70000\n", "P5 4\n", "P5 a 4 255\n", "P5 4 4 255\nabc",
        "P2 2 2 255 1 2 3", "P2 2 2 255 1 2 3 400"}) {
    write_text(folder / "a.pgm", header);
    EXPECT_THROW(read_image_info(folder / "a.pgm"), FileError) << header;
  }
}

TEST(BadImageFile, MoreThanThreeDimensions) {
  const TemporaryFolder folder;
  write_text(
      folder / "a.nrrd",
      "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 2 2\nencoding: raw\n\n0123456789abcdef");
  expect_refused(folder / "a.nrrd", "only 2 and 3 are supported");
}

TEST(BadImageFile, RealFilesThatAreDamagedOrUnsupported) {
  CREASE_NEEDS("readers/MR_truncated.dcm");
  expect_refused(shared_file("readers/MR_truncated.dcm"), "truncated");
  expect_refused(shared_file("readers/no_meta.dcm"), "not a DICOM file");
  expect_refused(shared_file("readers/example_nifti2.nii.gz"), "NIfTI-2");
  expect_refused(shared_file("readers/nifti1.hdr"), "is missing");
}

TEST(BadImageFile, TruncatedRealDicomFiles) {
  CREASE_NEEDS("readers/MR_small_RLE.dcm");
  const TemporaryFolder folder;
  for (const char* name : {"MR_small_RLE.dcm", "MR_small_implicit.dcm", "MR_small_bigendian.dcm"}) {
    const std::string whole = read_text(shared_file(std::string("readers/") + name));
    for (std::size_t length = 1; length < whole.size(); length += 211) {
      write_text(folder / "a.dcm", whole.substr(0, length));
      EXPECT_THROW(read_image_info(folder / "a.dcm"), FileError) << name << " cut to " << length;
    }
  }
}

}  // namespace
}  // namespace crease

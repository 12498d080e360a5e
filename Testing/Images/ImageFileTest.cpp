#include "Images/ImageFile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "Core/Error.h"
#include "Testing/Images/TestFiles.h"
#include "Testing/Images/TestImages.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::image_of;
using ::testing::IsEmpty;
using testing::plain_raster;
using testing::read_text;
using testing::TemporaryFolder;
using ::testing::ThrowsMessage;
using testing::turned_raster;
using testing::write_text;

template <int Dim>
constexpr std::array<int, Dim> test_size() {
  if constexpr (Dim == 2) return {13, 7};
  if constexpr (Dim == 3) return {13, 7, 5};
}

/// Whole numbers that differ from pixel to pixel along every axis.
template <int Dim>
Image<float, Dim> numbered_image(const Raster<Dim>& raster, double first, double step) {
  return image_of(raster, [=](const Vector<Dim>& i) {
    return first + step * (i[0] + 17 * i[1] + (Dim == 3 ? 119 * i[Dim - 1] : 0));
  });
}

/// Headers keep spacing and origin to about single precision.
template <int Dim>
void expect_same_geometry(const Raster<Dim>& found, const Raster<Dim>& expected,
                          double tolerance = 1e-6) {
  EXPECT_EQ(found.size, expected.size);
  EXPECT_LT((found.spacing - expected.spacing).norm(), tolerance * expected.spacing.norm());
  EXPECT_LT((found.origin - expected.origin).norm(),
            tolerance * expected.origin.norm() + tolerance);
  EXPECT_LT((found.direction - expected.direction).norm(), 2 * tolerance);
}

struct FileCase {
  std::string name;
  PixelType type;
};

template <int Dim>
void expect_round_trip(const FileCase& c, bool geometry) {
  const TemporaryFolder folder;
  const double first = c.type == PixelType::kInt16 || c.type == PixelType::kFloat ? -300 : 3;
  const double step = c.type == PixelType::kUint8 ? 0.3 : 1.5;
  auto image = numbered_image<Dim>(turned_raster<Dim>(test_size<Dim>()), first, step);
  if (c.type != PixelType::kFloat && c.type != PixelType::kDouble) {
    for (float& v : image.values()) v = std::round(v);
  }
  write_image(folder / c.name, image, c.type);
  const auto read = read_image<Dim>(folder / c.name);
  EXPECT_EQ(read.image.values(), image.values());
  EXPECT_EQ(read.pixel_type, c.type);
  EXPECT_THAT(read.notes, IsEmpty());
  expect_same_geometry(read.image.raster(),
                       geometry ? image.raster() : plain_raster<Dim>(test_size<Dim>()));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_THAT(entry.path().filename().string(), HasSubstr("image"));  // nothing temporary is left
  }
}

class EveryFormat : public ::testing::TestWithParam<FileCase> {};
class MedicalFormats : public EveryFormat {};
class Pictures : public EveryFormat {};
class PictureStacks : public EveryFormat {};

std::string case_name(const ::testing::TestParamInfo<FileCase>& info) {
  std::string name = info.param.name + "_" + std::string(to_string(info.param.type));
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

TEST_P(MedicalFormats, KeepPixelsAndGeometryIn2D) { expect_round_trip<2>(GetParam(), true); }
TEST_P(MedicalFormats, KeepPixelsAndGeometryIn3D) { expect_round_trip<3>(GetParam(), true); }
TEST_P(Pictures, KeepPixelsButNoGeometry) { expect_round_trip<2>(GetParam(), false); }
TEST_P(PictureStacks, KeepPixelsButNoGeometry) { expect_round_trip<3>(GetParam(), false); }

std::vector<FileCase> medical_cases() {
  std::vector<FileCase> cases;
  for (const char* name : {"image.mha", "image.mhd", "image.nii", "image.NII.GZ", "image.nrrd"}) {
    for (PixelType type : {PixelType::kUint8, PixelType::kUint16, PixelType::kInt16,
                           PixelType::kInt32, PixelType::kFloat, PixelType::kDouble}) {
      cases.push_back({name, type});
    }
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(All, MedicalFormats, ::testing::ValuesIn(medical_cases()), case_name);
INSTANTIATE_TEST_SUITE_P(All, Pictures,
                         ::testing::Values(FileCase{"image.png", PixelType::kUint8},
                                           FileCase{"image.PNG", PixelType::kUint16},
                                           FileCase{"image.tif", PixelType::kUint8},
                                           FileCase{"image.tiff", PixelType::kUint16},
                                           FileCase{"image.tif", PixelType::kInt16},
                                           FileCase{"image.tif", PixelType::kFloat},
                                           FileCase{"image.pgm", PixelType::kUint8},
                                           FileCase{"image.pgm", PixelType::kUint16}),
                         case_name);
INSTANTIATE_TEST_SUITE_P(All, PictureStacks,
                         ::testing::Values(FileCase{"image.tif", PixelType::kUint8},
                                           FileCase{"image.tif", PixelType::kFloat}),
                         case_name);

// JPEG loses a little; smooth images lose little.
TEST(ImageFile, JpegKeepsSmoothImagesToTwoGreyValues) {
  const TemporaryFolder folder;
  const auto image = image_of(plain_raster<2>({64, 48}), [](const Vector<2>& i) {
    return std::round(128 + 100 * std::sin(0.1 * i[0]) * std::cos(0.07 * i[1]));
  });
  write_image(folder / "image.jpg", image, PixelType::kUint8);
  const auto read = read_image<2>(folder / "image.jpg");
  for (std::size_t p = 0; p < image.values().size(); ++p) {
    EXPECT_NEAR(read.image.values()[p], image.values()[p], 2);
  }
}

TEST(ImageFile, WholeTypesRoundAndClamp) {
  const TemporaryFolder folder;
  const Image<float, 2> image(plain_raster<2>({3, 2}), {-7.0f, 0.4f, 0.6f, 254.6f, 255.4f, 1e9f});
  write_image(folder / "image.mha", image, PixelType::kUint8);
  EXPECT_EQ(read_image<2>(folder / "image.mha").image.values(),
            (std::vector<float>{0, 0, 1, 255, 255, 255}));
  write_image(folder / "image.mha", image, PixelType::kInt16);
  EXPECT_EQ(read_image<2>(folder / "image.mha").image.values(),
            (std::vector<float>{-7, 0, 1, 255, 255, 32767}));
}

TEST(ImageFile, RefusesNanForWholeTypes) {
  const TemporaryFolder folder;
  Image<float, 2> image(plain_raster<2>({3, 2}));
  image(1, 1) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { write_image(folder / "image.png", image, PixelType::kUint8); },
              ThrowsMessage<InvalidInput>(HasSubstr("not a number")));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ImageFile, SaysWhichFormatsHoldWhat) {
  const TemporaryFolder folder;
  const Image<float, 2> flat(plain_raster<2>({3, 2}));
  const Image<float, 3> volume(plain_raster<3>({3, 2, 2}));
  EXPECT_THAT([&] { write_image(folder / "a.dcm", flat, PixelType::kUint8); },
              ThrowsMessage<InvalidInput>(HasSubstr("DICOM files are only read")));
  EXPECT_THAT([&] { write_image(folder / "a.png", flat, PixelType::kFloat); },
              ThrowsMessage<InvalidInput>(HasSubstr("PNG files do not hold float pixels")));
  EXPECT_THAT([&] { write_image(folder / "a.png", volume, PixelType::kUint8); },
              ThrowsMessage<InvalidInput>(HasSubstr("images of 2 dimensions")));
  EXPECT_THAT([&] { write_image(folder / "a.xyz", flat, PixelType::kUint8); },
              ThrowsMessage<FileError>(HasSubstr("the image format is not known")));
  EXPECT_THAT([&] { write_image(folder / "no" / "a.mha", flat, PixelType::kUint8); },
              ThrowsMessage<FileError>(HasSubstr("does not exist")));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ImageFile, WritesOverAnOldFileOnlyWhenTheNewOneIsComplete) {
  const TemporaryFolder folder;
  write_text(folder / "image.mha", "old");
  Image<float, 2> image(plain_raster<2>({3, 2}));
  image(0, 0) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(write_image(folder / "image.mha", image, PixelType::kUint8), InvalidInput);
  EXPECT_EQ(read_text(folder / "image.mha"), "old");
  write_image(folder / "image.mha", image, PixelType::kFloat);
  EXPECT_TRUE(std::isnan(read_image<2>(folder / "image.mha").image(0, 0)));
}

TEST(ImageFile, CountsPixelsThatAreNotFinite) {
  const TemporaryFolder folder;
  auto image = numbered_image<3>(plain_raster<3>({5, 4, 3}), 0, 1);
  EXPECT_NO_THROW(check_finite(image, "fixed.mha"));
  image(3, 2, 1) = std::numeric_limits<float>::quiet_NaN();
  image(4, 3, 2) = std::numeric_limits<float>::infinity();
  EXPECT_THAT([&] { check_finite(image, "fixed.mha"); },
              ThrowsMessage<InvalidInput>(
                  AllOf(HasSubstr("fixed.mha: 2 pixels are not finite"), HasSubstr("(3, 2, 1)"))));
  for (const char* name : {"image.mha", "image.nii", "image.nii.gz", "image.nrrd", "image.tif"}) {
    write_image(folder / name, image, PixelType::kFloat);
    const auto info = read_image_info(folder / name);
    EXPECT_EQ(info.num_not_finite, 2) << name;
    EXPECT_EQ(info.header.dimension, 3);
    EXPECT_EQ(info.header.size, (std::array{5, 4, 3}));
    EXPECT_EQ(info.minimum, 0);
    EXPECT_EQ(info.maximum, 2 * 119 + 3 * 17 + 3);
    const auto read = read_image<3>(folder / name).image;
    EXPECT_TRUE(std::isnan(read(3, 2, 1))) << name;
    EXPECT_EQ(read(4, 3, 2), std::numeric_limits<float>::infinity()) << name;
  }
}

TEST(ImageFile, FieldsKeepValuesThatAreNotFinite) {
  const TemporaryFolder folder;
  DisplacementField<2> field(plain_raster<2>({4, 3}));
  field(2, 1) = Vector<2>(5, std::numeric_limits<double>::quiet_NaN());
  for (const char* name : {"field.mha", "field.nii.gz", "field.nrrd"}) {
    write_displacement_field(folder / name, field);
    const auto read = read_displacement_field<2>(folder / name);
    EXPECT_EQ(read(2, 1)[0], 5) << name;
    EXPECT_TRUE(std::isnan(read(2, 1)[1])) << name;
    EXPECT_EQ(read_image_info(folder / name).num_not_finite, 1) << name;
  }
}

TEST(ImageFile, ASingleSliceIs2D) {
  const TemporaryFolder folder;
  auto raster = plain_raster<3>({6, 5, 1});
  raster.origin = {3, -4, 77};
  raster.spacing = {0.5, 0.25, 3};
  const auto slice = numbered_image<3>(raster, 0, 1);
  for (const char* name : {"slice.mha", "slice.nii", "slice.nrrd"}) {
    write_image(folder / name, slice, PixelType::kUint8);
    EXPECT_EQ(read_image_header(folder / name).dimension, 2);
    const auto read = read_image<2>(folder / name);
    EXPECT_EQ(read.image.values(), slice.values());
    EXPECT_EQ(read.image.raster().origin, Point<2>(3, -4));
    EXPECT_EQ(read.image.raster().spacing, Vector<2>(0.5, 0.25));
    EXPECT_THROW(read_image<3>(folder / name), FileError);
  }
}

// A sagittal slice: its axes are y and z; distances along its own axes must stay what they are.
TEST(ImageFile, ASliceInAnotherPlaneGetsItsOwnCoordinates) {
  const TemporaryFolder folder;
  auto raster = plain_raster<3>({6, 5, 1});
  raster.origin = {77, 3, -4};
  raster.direction << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  write_image(folder / "slice.mha", numbered_image<3>(raster, 0, 1), PixelType::kUint8);
  const auto read = read_image<2>(folder / "slice.mha");
  EXPECT_LT((read.image.raster().origin - Point<2>(3, -4)).norm(), 1e-9);
  EXPECT_LT((read.image.raster().direction - Matrix<2>::Identity()).norm(), 1e-9);
  EXPECT_THAT(read.notes, Contains(HasSubstr("not parallel to the xy plane")));
}

TEST(ImageFile, ColourBecomesLuminanceAndIsSaid) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> bytes{255, 0, 0, 0, 255, 0, 0, 0, 255, 90, 90, 90};
  write_rgb_png(folder / "colour.png", 4, 1, bytes);
  const auto read = read_image<2>(folder / "colour.png");
  const std::vector<double> expected{0.299 * 255, 0.587 * 255, 0.114 * 255, 90};
  for (std::size_t p = 0; p < 4; ++p) EXPECT_NEAR(read.image.values()[p], expected[p], 1e-5);
  EXPECT_THAT(read.notes, Contains("colour converted to grey"));
  EXPECT_EQ(read.pixel_type, PixelType::kUint8);
  EXPECT_THAT([&] { read_labels<2>(folder / "colour.png"); },
              ThrowsMessage<FileError>(HasSubstr("this one has colours")));
  EXPECT_THROW(write_rgb_png(folder / "colour.png", 4, 2, bytes), InvalidInput);
}

TEST(ImageFile, MasksAreWhateverIsAboveZero) {
  const TemporaryFolder folder;
  const Image<float, 2> image(plain_raster<2>({4, 1}), {-1.0f, 0.0f, 0.1f, 7.0f});
  write_image(folder / "mask.mha", image, PixelType::kFloat);
  const auto mask = read_mask<2>(folder / "mask.mha");
  EXPECT_EQ(mask.values(), (std::vector<std::uint8_t>{0, 0, 1, 1}));
  for (const char* name : {"again.mha", "again.png"}) {
    write_mask(folder / name, mask);
    EXPECT_EQ(read_mask<2>(folder / name).values(), mask.values());
  }
  EXPECT_EQ(read_image_info(folder / "again.mha").maximum, 1);
  EXPECT_EQ(read_image_info(folder / "again.png").maximum, 255);
}

TEST(ImageFile, LabelsAreWholeNumbers) {
  const TemporaryFolder folder;
  for (std::int32_t largest : {3, 300, 100'000, 20'000'001}) {  // a float could not hold the last
    const LabelImage<2> labels(turned_raster<2>({3, 1}), {0, 1, largest});
    write_labels(folder / "labels.nii.gz", labels);
    EXPECT_EQ(read_labels<2>(folder / "labels.nii.gz").values(), labels.values());
  }
  for (float bad : {-1.0f, 1.5f, 1e10f, std::numeric_limits<float>::quiet_NaN()}) {
    write_image(folder / "bad.mha", Image<float, 2>(plain_raster<2>({3, 1}), {0, 1, bad}),
                PixelType::kFloat);
    EXPECT_THAT([&] { read_labels<2>(folder / "bad.mha"); },
                ThrowsMessage<FileError>(AllOf(HasSubstr("bad.mha"), HasSubstr("(2, 0)"))));
  }
  EXPECT_THROW(write_labels(folder / "bad.mha", LabelImage<2>(plain_raster<2>({2, 1}), {0, -1})),
               InvalidInput);
}

TEST(ImageFile, SaysWhenSinglePrecisionRounds) {
  const TemporaryFolder folder;
  write_image(folder / "large.mha",
              LabelImage<2>(plain_raster<2>({3, 1}), {16'777'216, 16'777'217, 5}),
              PixelType::kInt32);
  EXPECT_THAT(read_image<2>(folder / "large.mha").notes,
              Contains(HasSubstr("1 values beyond 2^24 are rounded")));
}

template <int Dim>
void expect_field_round_trip() {
  const TemporaryFolder folder;
  DisplacementField<Dim> field(turned_raster<Dim>(test_size<Dim>()));
  double next = -20.03;
  for (auto& u : field.values()) {
    for (int a = 0; a < Dim; ++a) u[a] = next += 0.37;
  }
  for (const char* name : {"field.mha", "field.nii.gz", "field.nrrd"}) {
    write_displacement_field(folder / name, field);
    EXPECT_EQ(read_displacement_field<Dim>(folder / name).values(), field.values()) << name;
    expect_same_geometry(read_displacement_field<Dim>(folder / name).raster(), field.raster());
    EXPECT_EQ(read_image_header(folder / name).num_components, Dim);
    EXPECT_EQ(read_image_header(folder / name).pixel_type, PixelType::kDouble);
    EXPECT_THAT([&] { read_image<Dim>(folder / name); },
                ThrowsMessage<FileError>(HasSubstr("vectors")));

    write_displacement_field(folder / name, field, PixelType::kFloat);
    const auto rounded = read_displacement_field<Dim>(folder / name);
    for (std::size_t p = 0; p < field.values().size(); ++p) {
      EXPECT_LT((rounded.values()[p] - field.values()[p]).norm(), 1e-4);  // of up to 500 mm
    }
  }
  EXPECT_THROW(write_displacement_field(folder / "field.png", field), InvalidInput);
  const auto scalar = numbered_image<Dim>(plain_raster<Dim>(test_size<Dim>()), 0, 1);
  write_image(folder / "scalar.mha", scalar, PixelType::kUint16);
  EXPECT_THAT([&] { read_displacement_field<Dim>(folder / "scalar.mha"); },
              ThrowsMessage<FileError>(HasSubstr("this file has 1")));
}

TEST(ImageFile, DisplacementFieldsKeepEveryBit2D) { expect_field_round_trip<2>(); }
TEST(ImageFile, DisplacementFieldsKeepEveryBit3D) { expect_field_round_trip<3>(); }

// Some programs write fields of slices as volumes of one slice with three components.
TEST(ImageFile, DisplacementFieldsOfOneSliceAre2D) {
  const TemporaryFolder folder;
  DisplacementField<3> field(plain_raster<3>({4, 3, 1}), Vector<3>(1.5, -2, 0));
  write_displacement_field(folder / "field.mha", field, PixelType::kFloat);
  const auto read = read_displacement_field<2>(folder / "field.mha");
  EXPECT_EQ(read(2, 1), Vector<2>(1.5, -2));
}

TEST(ImageFile, KnowsWhetherTheFileTellsItsSpacing) {
  const TemporaryFolder folder;
  const auto image = numbered_image<2>(plain_raster<2>(test_size<2>()), 3, 1);  // of 1 mm
  for (const char* name : {"i.mha", "i.nrrd", "i.nii"}) {
    write_image(folder / name, image, PixelType::kUint8);
    EXPECT_TRUE(read_image<2>(folder / name).spacing_known) << name;
  }
  for (const char* name : {"i.png", "i.jpg", "i.tif", "i.pgm"}) {
    write_image(folder / name, image, PixelType::kUint8);
    EXPECT_FALSE(read_image<2>(folder / name).spacing_known) << name;
  }
  write_text(folder / "plain.mha",
             "NDims = 2\nDimSize = 2 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\nab");
  write_text(folder / "plain.nrrd",
             "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 2 1\nencoding: raw\n\nab");
  for (const char* name : {"plain.mha", "plain.nrrd"}) {
    const auto read = read_image<2>(folder / name);
    EXPECT_FALSE(read.spacing_known) << name;
    EXPECT_EQ(read.image.raster().spacing, Vector<2>::Ones()) << name;
  }
}

TEST(ImageFile, ReadsTextAndBinaryPgm) {
  const TemporaryFolder folder;
  write_text(folder / "a.pgm", "P2\n# a comment\n3 2 # another\n1000\n0 1 2\n997 998\n999\n");
  const auto text = read_image<2>(folder / "a.pgm");
  EXPECT_EQ(text.image.values(), (std::vector<float>{0, 1, 2, 997, 998, 999}));
  EXPECT_EQ(text.pixel_type, PixelType::kUint16);
  write_text(folder / "b.pgm", std::string("P5 2 1 65535\n\x01\x02\xff\xfe", 17));
  EXPECT_EQ(read_image<2>(folder / "b.pgm").image.values(), (std::vector<float>{258, 65534}));
}

TEST(ImageFile, RecognisesFilesWithoutAKnownName) {
  const TemporaryFolder folder;
  const auto image = numbered_image<2>(plain_raster<2>({5, 4}), 0, 1);
  for (const char* name : {"a.png", "a.mha", "a.nii", "a.nrrd", "a.tif", "a.pgm", "a.jpg"}) {
    write_image(folder / name, image, PixelType::kUint8);
    std::filesystem::rename(folder / name, folder / "nameless");
    EXPECT_EQ(read_image_header(folder / "nameless").size, (std::array{5, 4, 1})) << name;
  }
}

}  // namespace
}  // namespace crease

#include "Registration/Pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "Core/Error.h"
#include "Images/ImageFile.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using Rgb = std::array<int, 3>;
constexpr Rgb kFolded = {57, 255, 20}, kFeature = {255, 140, 0}, kNeutral = {247, 247, 247};
constexpr int kLeft = 16, kTop = 30;  // of the first panel

Rgb pixel(const Picture& picture, int x, int y) {
  const std::uint8_t* p = &picture.rgb[(std::size_t(y) * picture.width + x) * 3];
  return {p[0], p[1], p[2]};
}

int count(const Picture& picture, const Rgb& colour) {
  int n = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) n += pixel(picture, x, y) == colour;
  }
  return n;
}

template <int Dim>
Image<float, Dim> waves(const std::array<int, Dim>& size) {
  Raster<Dim> raster;
  raster.size = size;
  Image<float, Dim> image(raster);
  for (std::size_t i = 0; i < image.values().size(); ++i) {
    image.values()[i] = static_cast<float>(std::sin(0.37 * static_cast<double>(i)));
  }
  return image;
}

void expect_complete(const Picture& picture) {
  EXPECT_EQ(picture.rgb.size(), std::size_t(picture.width) * picture.height * 3);
}

TEST(Pictures, SmallImagesAreEnlargedAndLargeOnesShrunkInProportion) {
  const Picture small = image_picture(waves<2>({64, 32}), "");
  expect_complete(small);
  EXPECT_GE(small.width, 560);
  EXPECT_LT(small.width, 640);
  EXPECT_NEAR(small.height, 280 + 46, 2);
  EXPECT_LT(image_picture(waves<2>({2600, 100}), "").width, 1300);
}

TEST(Pictures, SpacingGivesTheProportions) {
  auto image = waves<2>({64, 64});
  auto raster = image.raster();
  raster.spacing = {1, 2};
  const Picture picture =
      image_picture(Image<float, 2>(raster, std::move(image).take_values()), "");
  EXPECT_NEAR(picture.height - 46, 2 * (picture.width - 32), 4);
}

TEST(Pictures, VolumesShowThreeSlices) {
  const Picture picture = image_picture(waves<3>({16, 24, 32}), "Volume");
  expect_complete(picture);
  EXPECT_GE(picture.width, (16 + 16 + 24) * 560 / 32);
}

TEST(Pictures, CheckerboardOfEqualImagesShowsNoSquares) {
  const auto image = waves<2>({80, 80});
  const Picture alone = image_picture(image, ""), board = checkerboard_picture(image, image);
  ASSERT_EQ(alone.width, board.width);
  for (int y = kTop; y < kTop + 560; y += 7) {
    for (int x = kLeft; x < kLeft + 560; x += 3) {
      ASSERT_EQ(pixel(alone, x, y), pixel(board, x, y)) << x << ' ' << y;
    }
  }
}

TEST(Pictures, CheckerboardTakesSquaresInTurn) {
  Raster<2> raster;
  raster.size = {80, 80};
  Image<float, 2> left(raster), right(raster);
  for (int j = 0; j < 80; ++j) {
    for (int i = 0; i < 80; ++i) {
      left(i, j) = i < 40 ? 0.0f : 1.0f;  // dark, bright
      right(i, j) = 1 - left(i, j);
    }
  }
  const Picture board = checkerboard_picture(left, right);
  const int square = 560 / 8;
  EXPECT_EQ(pixel(board, kLeft + square / 2, kTop + square / 2), (Rgb{0, 0, 0}));
  EXPECT_EQ(pixel(board, kLeft + 3 * square / 2, kTop + square / 2), (Rgb{255, 255, 255}));
  EXPECT_EQ(pixel(board, kLeft + square / 2, kTop + 3 * square / 2), (Rgb{255, 255, 255}));
}

TEST(Pictures, DifferencesShareOneScaleAboutWhite) {
  const auto fixed = waves<2>({60, 60});
  auto before = fixed;
  for (float& v : before.values()) v += 2;
  const Picture picture = difference_picture(fixed, before, fixed);
  expect_complete(picture);
  const int second = kLeft + 560 + 16;
  const Rgb end = pixel(picture, kLeft + 200, kTop + 200);  // the scale's upper end: dark red
  EXPECT_NEAR(end[0], 103, 2);
  EXPECT_NEAR(end[1], 0, 2);
  EXPECT_NEAR(end[2], 31, 2);
  EXPECT_EQ(pixel(picture, second + 200, kTop + 200), kNeutral);
}

// Only the caption changes: differences elsewhere are drawn, but not in the rms.
TEST(Pictures, TheRmsOfABodyIsThatOfItsPixels) {
  const auto fixed = waves<2>({60, 60});
  auto before = fixed;
  before(3, 3) += 50;
  Mask<2> body(fixed.raster());
  std::ranges::fill(body.values(), std::uint8_t{1});
  const Picture all = difference_picture(fixed, before, fixed, &body);
  body(3, 3) = 0;
  const Picture without = difference_picture(fixed, before, fixed, &body);
  EXPECT_EQ(pixel(all, kLeft + 200, kTop + 200), pixel(without, kLeft + 200, kTop + 200));
  EXPECT_NE(all.rgb, without.rgb);
}

TEST(Pictures, PixelsFromOutsideTheMovingImageAreGrey) {
  const auto fixed = waves<2>({56, 56});
  auto warped = fixed;
  warped(10, 10) = std::nanf("");
  const Picture picture = difference_picture(fixed, fixed, warped);
  const int second = kLeft + 560 + 16;
  EXPECT_EQ(pixel(picture, second + 105, kTop + 105), (Rgb{190, 190, 190}));
  EXPECT_EQ(pixel(picture, kLeft + 105, kTop + 105), kNeutral);
  expect_complete(image_picture(warped, "warped"));
  expect_complete(checkerboard_picture(fixed, warped));
}

TEST(Pictures, FoldedPixelsAreLoud) {
  Raster<2> raster;
  raster.size = {70, 70};
  Image<float, 2> determinants(raster, 1.0f);
  EXPECT_EQ(count(jacobian_picture(determinants), kFolded), 0);
  EXPECT_EQ(pixel(jacobian_picture(determinants), kLeft + 100, kTop + 100), kNeutral);
  determinants(35, 20) = -0.1f;
  const Picture picture = jacobian_picture(determinants);
  EXPECT_EQ(pixel(picture, kLeft + 35 * 8 + 4, kTop + 20 * 8 + 4), kFolded);
  EXPECT_GE(count(picture, kFolded), 64);
}

TEST(Pictures, OneFoldedPixelOfALargeImageIsStillSeen) {
  Raster<2> raster;
  raster.size = {2601, 90};
  Image<float, 2> determinants(raster, 1.0f);
  const int legend = count(jacobian_picture(determinants), kFolded);
  determinants(1234, 45) = 0;
  const Picture picture = jacobian_picture(determinants);
  bool seen = false;
  for (int x = kLeft; x < kLeft + 1200; ++x) {
    for (int y = kTop; y < kTop + 30; ++y) seen = seen || pixel(picture, x, y) == kFolded;
  }
  EXPECT_TRUE(seen);
  EXPECT_EQ(legend, 0);
}

TEST(Pictures, JacobianShrinkingIsBlueAndGrowingRed) {
  Raster<2> raster;
  raster.size = {56, 56};
  Image<float, 2> determinants(raster, 0.5f);
  for (int j = 0; j < 56; ++j) {
    for (int i = 28; i < 56; ++i) determinants(i, j) = 2;
  }
  const Picture picture = jacobian_picture(determinants);
  const Rgb left = pixel(picture, kLeft + 100, kTop + 100);
  const Rgb right = pixel(picture, kLeft + 450, kTop + 100);
  EXPECT_GT(left[2], left[0] + 50);
  EXPECT_GT(right[0], right[2] + 50);
}

TEST(Pictures, UndefinedDeterminantsAreGrey) {
  Raster<2> raster;
  raster.size = {56, 56};
  Image<float, 2> determinants(raster, 1.0f);
  determinants(10, 10) = std::nanf("");
  EXPECT_EQ(pixel(jacobian_picture(determinants), kLeft + 105, kTop + 105), (Rgb{190, 190, 190}));
}

// 99.9 % of the strains are within the scale; a stray one does not darken all others.
TEST(Pictures, StrainRunsFromDarkBlueToYellow) {
  Raster<2> raster;
  raster.size = {56, 56};
  Image<float, 2> strain(raster, 0.0f);
  for (int j = 0; j < 56; ++j) {
    for (int i = 28; i < 56; ++i) strain(i, j) = 0.5f;
  }
  strain(28, 28) = 40;
  const Picture picture = strain_picture(strain);
  expect_complete(picture);
  EXPECT_EQ(pixel(picture, kLeft + 100, kTop + 100), (Rgb{68, 1, 84}));
  EXPECT_EQ(pixel(picture, kLeft + 450, kTop + 100), (Rgb{253, 231, 37}));
  expect_complete(strain_picture(waves<3>({8, 9, 10})));
}

TEST(Pictures, FeatureLinesAreDrawnWhereTheMapBringsThem) {
  const auto moving = waves<2>({100, 100});
  DeformationDrawing<2> drawing;
  drawing.fixed_raster = moving.raster();
  drawing.grid_lines = 0;
  drawing.map = [](const Point<2>& x) { return Point<2>(x + Vector<2>(20, 0)); };
  FeatureLine line;
  line.points = {{30, 10}, {30, 90}};
  drawing.feature_lines = {line};
  const Picture picture = deformation_picture(moving, drawing);
  expect_complete(picture);
  const auto column = [](double x) { return kLeft + static_cast<int>((x + 0.5) * 5.6); };
  EXPECT_EQ(pixel(picture, column(50), kTop + 280), kFeature);
  EXPECT_NE(pixel(picture, column(30), kTop + 280), kFeature);
}

TEST(Pictures, GridAndMeshAndLandmarksAreDrawnTheSameEveryTime) {
  const auto moving = waves<2>({90, 70});
  SimplexMesh<2> mesh;
  mesh.vertices = {{0, 0}, {80, 0}, {0, 60}};
  mesh.simplices = {{0, 1, 2}};
  DeformationDrawing<2> drawing;
  drawing.fixed_raster = moving.raster();
  drawing.map = [](const Point<2>& x) {
    if (x.x() > 60) return Point<2>(Point<2>::Constant(std::nan("")));  // no value there
    return Point<2>(x + Vector<2>(3 * std::sin(x.y() / 9), 0));
  };
  drawing.landmarks.fixed = {{20, 20}, {70, 20}};
  drawing.landmarks.moving = {{22, 21}, {70, 20}};
  const Picture grid = deformation_picture(moving, drawing);
  EXPECT_EQ(grid.rgb, deformation_picture(moving, drawing).rgb);
  drawing.mesh = &mesh;
  const Picture edges = deformation_picture(moving, drawing);
  EXPECT_NE(grid.rgb, edges.rgb);
}

TEST(Pictures, DeformationOfAVolume) {
  const auto moving = waves<3>({20, 24, 16});
  DeformationDrawing<3> drawing;
  drawing.fixed_raster = moving.raster();
  drawing.map = [](const Point<3>& x) { return x; };
  expect_complete(deformation_picture(moving, drawing));
}

TEST(Pictures, WrittenFileIsAPngOfThatSize) {
  const Picture picture = image_picture(waves<2>({64, 32}), "Waves");
  const auto path = std::filesystem::path(::testing::TempDir()) / "picture.png";
  write_picture(path, picture);
  const ImageHeader header = read_image_header(path);
  EXPECT_EQ(header.format, ImageFormat::kPng);
  EXPECT_EQ(header.num_components, 1);  // nothing in it has a colour
  EXPECT_EQ(header.size[0], picture.width);
  EXPECT_EQ(header.size[1], picture.height);
  write_picture(path, jacobian_picture(waves<2>({64, 32})));
  EXPECT_EQ(read_image_header(path).num_components, 3);
  EXPECT_THROW(write_picture("no/such/folder/picture.png", picture), FileError);
}

TEST(Pictures, ImagesOfUnequalSizesAreRefused) {
  EXPECT_THAT(
      [] {
        checkerboard_picture(waves<2>({20, 20}), waves<2>({20, 21}));
      },
      ThrowsMessage<InvalidInput>(HasSubstr("resample")));
}

}  // namespace
}  // namespace crease

#include "Registration/Mammogram/MammogramFrame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "Core/Error.h"
#include "Images/ImageFile.h"
#include "Testing/Registration/Mammogram/DrawnBreast.h"
#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

using ::testing::Contains;
using testing::draw_breast;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

/// The film in the middle of a larger image of zeros.
Image<float, 2> padded(const Image<float, 2>& film, int left, int right) {
  Raster<2> raster = film.raster();
  raster.size[0] += left + right;
  Image<float, 2> image(raster);
  for (int j = 0; j < film.size()[1]; ++j) {
    std::copy(film.row(j).begin(), film.row(j).end(), image.row(j).begin() + left);
  }
  return image;
}

TEST(MammogramFrame, LeavesPaddingOutAndKeepsTheFilm) {
  const auto film = testing::quantized(draw_breast().image, 255);
  const MammogramFrame frame = find_frame(padded(film, 100, 60));
  EXPECT_EQ(frame.first, (std::array{100, 0}));
  EXPECT_EQ(frame.size, film.size());
  EXPECT_EQ(frame.image.values(), film.values());
  EXPECT_NEAR(frame.image.raster().origin.x(), 20.0, 1e-12);
}

TEST(MammogramFrame, CutsScannerLinesOff) {
  auto film = testing::quantized(draw_breast().image, 255);
  for (int i = 0; i < film.size()[0]; ++i) film(i, 0) = film(i, 1) = 255;
  for (int j = 0; j < film.size()[1]; ++j) film(film.size()[0] - 1, j) = 250;
  const MammogramFrame frame = find_frame(film);
  EXPECT_EQ(frame.first, (std::array{0, 2}));
  EXPECT_EQ(frame.size, (std::array{film.size()[0] - 1, film.size()[1] - 2}));
  EXPECT_THAT(frame.notes, Contains(HasSubstr("upper")));
  EXPECT_THAT(frame.notes, Contains(HasSubstr("right")));
}

// The chest wall is bright along the left edge, too, but far wider than a scanner's line.
TEST(MammogramFrame, KeepsTheChestWall) {
  const auto film = draw_breast({.pectoral = true}).image;
  const MammogramFrame frame = find_frame(film);
  EXPECT_EQ(frame.first, (std::array{0, 0}));
  EXPECT_EQ(frame.size, film.size());
}

TEST(MammogramFrame, TurnsNegativesRound) {
  const auto film = testing::quantized(draw_breast().image, 4095);
  const MammogramFrame plain = find_frame(film), turned = find_frame(testing::negative(film, 4095));
  EXPECT_FALSE(plain.inverted);
  EXPECT_TRUE(turned.inverted);
  EXPECT_THAT(turned.notes, Contains(HasSubstr("negative")));
  const float sum = static_cast<float>(turned.value_sum);
  for (std::size_t i = 0; i < film.values().size(); i += 97) {
    EXPECT_EQ(turned.image.values()[i], sum - 4095 + film.values()[i]);
  }
}

// Where both the border and the centre show the background, its own grey value tells.
TEST(MammogramFrame, TurnsNegativesOfSmallBreastsRound) {
  const auto film = testing::quantized(draw_breast({.width = 1100, .height = 1300}).image, 255);
  EXPECT_FALSE(find_frame(film).inverted);
  EXPECT_TRUE(find_frame(testing::negative(film, 255)).inverted);
}

TEST(MammogramFrame, AssumesAPixelSizeOnlyWhereNoneIsKnown) {
  auto film = draw_breast().image;
  Raster<2> unknown = film.raster();
  unknown.spacing.setOnes();
  const MammogramFrame assumed =
      find_frame(Image<float, 2>(unknown, film.values()), {.spacing_known = false});
  EXPECT_EQ(assumed.raster.spacing, Vector<2>::Constant(0.2));
  EXPECT_THAT(assumed.notes, Contains(HasSubstr("0.2 mm")));
  EXPECT_THAT(find_frame(film).notes, Not(Contains(HasSubstr("pixel size"))));
  const MammogramFrame believed = find_frame(Image<float, 2>(unknown, film.values()));
  EXPECT_EQ(believed.raster.spacing, Vector<2>::Ones());  // 1 mm may be the truth
  EXPECT_THAT(believed.notes, Not(Contains(HasSubstr("pixel size"))));
  const MammogramFrame given = find_frame(Image<float, 2>(unknown, film.values()),
                                          {.pixel_size_mm = 0.1, .spacing_known = false});
  EXPECT_EQ(given.raster.spacing, Vector<2>::Constant(0.1));
  EXPECT_EQ(given.image.size(), (std::array{280, 350}));
}

TEST(MammogramFrame, BelievesAFileThatSaysOneMillimetre) {
  const testing::TemporaryFolder folder;
  Raster<2> raster;
  raster.size = {200, 256};
  const Image<float, 2> film(
      raster, testing::quantized(draw_breast({.width = 200, .height = 256}).image, 255).values());
  const auto frame_of_file = [&](const char* name) {
    write_image(folder / name, film, PixelType::kUint8);
    const ReadImage<2> read = read_image<2>(folder / name);
    return find_frame(read.image, {.spacing_known = read.spacing_known});
  };
  const MammogramFrame told = frame_of_file("film.mha"), untold = frame_of_file("film.png");
  EXPECT_EQ(told.raster.spacing, Vector<2>::Ones());
  EXPECT_THAT(told.notes, Not(Contains(HasSubstr("pixel size"))));
  EXPECT_EQ(untold.raster.spacing, Vector<2>::Constant(0.2));
  EXPECT_THAT(untold.notes, Contains(HasSubstr("0.2 mm is assumed")));
}

TEST(MammogramFrame, ResamplingKeepsTheMeanAndThePlace) {
  auto film = draw_breast({.noise = 0.015}).image;
  Raster<2> fine = film.raster();
  fine.spacing.setConstant(0.07);
  fine.origin = {3, -8};
  const Image<float, 2> image(fine, film.values());
  const MammogramFrame frame = find_frame(image);
  EXPECT_NEAR(frame.image.raster().spacing.x(), 0.2, 1e-3);
  EXPECT_LT((frame.image.raster().bounds().lower - fine.bounds().lower).norm(), 1e-9);
  EXPECT_LT((frame.image.raster().bounds().upper - fine.bounds().upper).norm(), 1e-9);
  const auto mean = [](const Image<float, 2>& of) {
    return std::accumulate(of.values().begin(), of.values().end(), 0.0) / of.values().size();
  };
  EXPECT_NEAR(mean(frame.image), mean(image), 1e-5);  // single precision
}

TEST(MammogramFrame, CoarseImagesAreRefinedAndHugeOnesReduced) {
  auto film = draw_breast().image;
  Raster<2> coarse = film.raster();
  coarse.spacing.setConstant(0.4);
  EXPECT_EQ(find_frame(Image<float, 2>(coarse, film.values())).image.size(),
            (std::array{1120, 1400}));
  MammogramFrameOptions options;
  options.largest = 350;
  const MammogramFrame reduced = find_frame(film, options);
  EXPECT_EQ(reduced.image.size(), (std::array{280, 350}));
  EXPECT_THAT(reduced.notes, Contains(HasSubstr("very large")));
}

TEST(MammogramFrame, MirrorsWithinItself) {
  auto film = draw_breast().image;
  Raster<2> raster = film.raster();
  raster.origin = {11, 5};
  const auto image = padded(Image<float, 2>(raster, film.values()), 0, 100);
  const MammogramFrame frame = find_frame(image), mirror = mirrored(frame);
  const int width = frame.size[0];
  for (const auto& [i, j] : {std::pair(0, 0), std::pair(width - 1, 300), std::pair(17, 600)}) {
    const Vector<2> here(i, j), there(width - 1 - i, j);
    EXPECT_LT((mirror.raster.point(here) - frame.raster.point(there)).norm(), 1e-9);
    EXPECT_LT((frame.reflection()(frame.raster.point(here)) - mirror.raster.point(here)).norm(),
              1e-9);
    EXPECT_EQ(mirror.image(i, j), frame.image(width - 1 - i, j));
  }
  EXPECT_EQ(mirror.image.raster().origin, frame.image.raster().origin);
  const MammogramFrame twice = mirrored(mirror);
  EXPECT_LT((twice.raster.origin - frame.raster.origin).norm(), 1e-9);
  EXPECT_LT((twice.raster.direction - frame.raster.direction).norm(), 1e-12);
  EXPECT_EQ(twice.image.values(), frame.image.values());
}

TEST(MammogramFrame, UprightImageIsBrightOnTheFramesRaster) {
  const auto film = testing::quantized(draw_breast().image, 255);
  const auto negative = testing::negative(film, 255);
  const MammogramFrame frame = mirrored(find_frame(negative));
  const Image<float, 2> upright = upright_image(negative, frame);
  EXPECT_EQ(upright.raster().direction, frame.raster.direction);
  EXPECT_EQ(upright(100, 350), static_cast<float>(frame.value_sum) - negative(100, 350));
  EXPECT_THROW(upright_image(draw_breast({.width = 300}).image, frame), InvalidInput);
}

TEST(MammogramFrame, RefusesWhatIsNoMammogram) {
  MammogramFrameOptions options;
  options.name = "left.png";
  const auto refused = [&](const Image<float, 2>& image, const char* reason) {
    EXPECT_THAT(
        [&] { find_frame(image, options); },
        ThrowsMessage<InvalidInput>(::testing::AllOf(HasSubstr("left.png"), HasSubstr(reason))));
  };
  Raster<2> raster;
  raster.size = {127, 400};
  refused(Image<float, 2>(raster, 1.0f), "too few");
  raster.size = {300, 400};
  refused(Image<float, 2>(raster, 1.0f), "all pixels");
  auto image = draw_breast().image;
  image(3, 4) = std::numeric_limits<float>::quiet_NaN();
  refused(image, "not finite");
  options.pixel_size_mm = -0.1;
  refused(draw_breast().image, "-0.1 mm");
}

}  // namespace
}  // namespace crease

#include "Images/PngEncoder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "Core/Error.h"
#include "Images/ImageFile.h"
#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

std::vector<std::uint8_t> noise(std::size_t count) {
  std::mt19937 random(7);
  std::vector<std::uint8_t> bytes(count);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random() & 255);
  return bytes;
}

/// The colour type in the file's header: 0 grey, 2 red, green, blue.
int colour_type(const std::string& png) { return png.at(25); }

// ITK's reader (libpng) gives back every byte: filters, checksums and sizes are as the format says.
TEST(PngEncoder, GreyPixelsComeBackAsTheyWere) {
  const testing::TemporaryFolder folder;
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(37, 21), std::pair(1, 300)}) {
    const auto bytes = noise(std::size_t(width) * height);
    const std::string file = folder.write("grey.png", encode_png(width, height, 1, bytes));
    const auto read = read_image<2>(file);
    ASSERT_EQ(read.image.size(), (std::array<int, 2>{width, height}));
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), read.image.values().begin()));
  }
}

TEST(PngEncoder, ColoursComeBackAsTheirLuminance) {
  const testing::TemporaryFolder folder;
  const auto bytes = noise(3 * 50 * 40);
  const std::string png = encode_png(50, 40, 3, bytes);
  EXPECT_EQ(colour_type(png), 2);
  const auto read = read_image<2>(folder.write("colour.png", png));
  for (std::size_t p = 0; p < read.image.values().size(); ++p) {
    const double expected =
        0.299 * bytes[3 * p] + 0.587 * bytes[3 * p + 1] + 0.114 * bytes[3 * p + 2];
    ASSERT_NEAR(read.image.values()[p], expected, 1e-3) << p;
  }
}

TEST(PngEncoder, GreyPicturesTakeAThirdOfTheBytes) {
  const auto bytes = noise(64 * 64);
  std::vector<std::uint8_t> rgb;
  for (const auto byte : bytes) rgb.insert(rgb.end(), 3, byte);
  EXPECT_EQ(encode_png(64, 64, 3, rgb), encode_png(64, 64, 1, bytes));
  rgb.back() ^= 1;
  EXPECT_EQ(colour_type(encode_png(64, 64, 3, rgb)), 2);
}

TEST(PngEncoder, RefusesWhatIsNoPicture) {
  const std::vector<std::uint8_t> bytes(12);
  EXPECT_THROW(encode_png(0, 4, 3, bytes), InvalidInput);
  EXPECT_THROW(encode_png(2, 2, 2, bytes), InvalidInput);
  EXPECT_THROW(encode_png(4, 4, 1, bytes), InvalidInput);
}

}  // namespace
}  // namespace crease

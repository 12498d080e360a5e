#include "Transforms/Base64.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace crease {

// RFC 4648: the bytes of 1.0f are 00 00 80 3f, of 1.0 00 00 00 00 00 00 f0 3f.
TEST(Base64, IsThatOfTheStandard) {
  EXPECT_EQ(encode_numbers(std::vector<double>{1}).text, "AACAPw==");
  EXPECT_EQ(encode_numbers(std::vector<double>{1}).type, "float32");
  EXPECT_EQ(encode_numbers(std::vector<double>{1, 0.1}).type, "float64");
  EXPECT_EQ(encode_numbers(std::vector<double>{1, 0.1}).text, "AAAAAAAA8D+amZmZmZm5Pw==");
}

TEST(Base64, KeepsEveryBit) {
  const double large = std::numeric_limits<double>::max();
  for (const auto& numbers :
       {std::vector<double>{}, {-0.0}, {0.5, -3}, {0.5, -3, 2e-30f}, {1e-310, large}, {0.1}}) {
    const auto encoded = encode_numbers(numbers);
    const auto decoded = decode_numbers(encoded.type, encoded.text);
    ASSERT_TRUE(decoded);
    ASSERT_EQ(*decoded, numbers);
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      EXPECT_EQ(std::signbit((*decoded)[k]), std::signbit(numbers[k]));
    }
  }
}

TEST(Base64, RefusesWhatItCannotBe) {
  EXPECT_TRUE(decode_numbers("float32", "AACAPw=="));
  EXPECT_FALSE(decode_numbers("float64", "AACAPw=="));  // half a number
  EXPECT_FALSE(decode_numbers("float32", "AACAPw="));
  EXPECT_FALSE(decode_numbers("float32", "AACA*w=="));
  EXPECT_FALSE(decode_numbers("float32", "AA==APw="));
  EXPECT_FALSE(decode_numbers("float16", "AACAPw=="));
}

}  // namespace crease

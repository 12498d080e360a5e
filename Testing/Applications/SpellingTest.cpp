#include "Applications/Spelling.h"

#include <gtest/gtest.h>

#include <vector>

namespace crease {
namespace {

TEST(Spelling, CountsEdits) {
  EXPECT_EQ(edit_distance("mesh-size", "mesh-size"), 0);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("metrci", "metric"), 1);  // one swap
  EXPECT_EQ(edit_distance("", "abc"), 3);
}

TEST(Spelling, FindsTheNearestWordButNoneThatIsFar) {
  const std::vector<std::string> words = {"degree", "mesh-size", "metric"};
  EXPECT_EQ(nearest_word("mesh_size", words), "mesh-size");
  EXPECT_EQ(nearest_word("metrc", words), "metric");
  EXPECT_EQ(nearest_word("orientations", words), "");
}

TEST(Spelling, ListsWords) {
  EXPECT_EQ(one_of(std::vector<std::string>{"a", "b", "c"}), "a, b or c");
  EXPECT_EQ(one_of(std::vector<std::string>{"a"}), "a");
}

}  // namespace
}  // namespace crease

// ITK's text files as people and programs write and damage them. What ITK itself writes is in
// Testing/Interoperability.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Testing/TemporaryFolder.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ItkText : public ::testing::Test {
 protected:
  static std::string head() { return "#Insight Transform File V1.0\n"; }
  static std::string shift(const char* name, const char* numbers) {
    return message("Transform: ", name, "\nParameters: ", numbers, "\nFixedParameters: \n");
  }
  std::string write(const std::string& text) const { return folder_.write("a.tfm", text); }
  /// A file with this content is refused with these words.
  void expect_error(const std::string& content, const std::string& part) const {
    const std::string file = write(content);
    EXPECT_THAT([&] { load_transform<2>(file); },
                ThrowsMessage<FileError>(::testing::AllOf(HasSubstr(file), HasSubstr(part))));
  }
  void expect_error_after_head(const std::string& content, const std::string& part) const {
    expect_error(head() + content, part);
  }

 private:
  testing::TemporaryFolder folder_;
};

}  // namespace

TEST_F(ItkText, MayHaveLineEndsOfWindowsAndNumbersInAnyForm) {
  const auto file = write(
      "#Insight Transform File V1.0\r\n#Transform 0\r\nTransform: "
      "AffineTransform_double_2_2\r\n  Parameters:   1 0.5e+00 -0 1.\t3 -4E1 "
      "\r\n\r\nFixedParameters: 0 0\r\n");
  EXPECT_EQ(load_transform<2>(file)->map({2, 2}), (Point<2>(6, -38)));
  const auto info = peek_transform(file);
  EXPECT_EQ(info.in_dim, 2);
  EXPECT_EQ(info.type, "affine");
  EXPECT_EQ(info.format, "ITK text");
}

TEST_F(ItkText, CompositesApplyTheLastOneFirst) {
  const auto file =
      write(head() + "Transform: CompositeTransform_double_2_2\n" +
            "Transform: ScaleTransform_double_2_2\nParameters: 2 3\nFixedParameters: 0 0\n" +
            shift("TranslationTransform_double_2_2", "10 0"));
  EXPECT_EQ(load_transform<2>(file)->map({1, 1}), (Point<2>(22, 3)));
  EXPECT_EQ(peek_transform(file).type, "composite");
}

// A linear spline over 2 x 1 spans; before ITK 4 the direction was not told.
TEST_F(ItkText, OldSplinesLackTheDirection) {
  const std::string numbers = "Parameters: 0 1 2 0 1 2 0 0 0 0 0 0\n";
  const std::string name = "Transform: BSplineDeformableTransform_double_2_2_1\n";
  const auto old_file = write(head() + name + numbers + "FixedParameters: 3 2 5 5 10 10\n");
  EXPECT_LT((load_transform<2>(old_file)->map({10, 8}) - Point<2>(10.5, 8)).norm(), 1e-14);
  const auto file = write(head() + name + numbers + "FixedParameters: 3 2 5 5 10 10 0 -1 1 0\n");
  // The first axis of the grid runs upwards.
  EXPECT_LT((load_transform<2>(file)->map({2, 10}) - Point<2>(2.5, 10)).norm(), 1e-14);
}

TEST_F(ItkText, SaysWhereTheTextIsDamaged) {
  expect_error("", "is empty or cannot be read");
  expect_error("fixed_x,fixed_y\n1,2\n", "does not begin with \"#Insight Transform File\"");
  expect_error("(Transform \"AffineTransform\")\n", "is a parameter file of elastix");
  expect_error(head(), "holds no transform");
  expect_error_after_head("Parameters: 1\n", "line 2: comes before the first \"Transform:\"");
  expect_error_after_head("Transform AffineTransform_double_2_2\n", "line 2: has no colon");
  expect_error_after_head("\nMatrix: 1\n", "line 3: begins with \"Matrix\", which is unknown");
  expect_error_after_head(shift("TranslationTransform_double_2_2", "1 2,5"),
                          "line 3: has \"2,5\" as number 2");
  expect_error_after_head("Transform: TranslationTransform_double_2_2\nParameters: 1 2.",
                          "ends within a line");
  expect_error_after_head("ComponentTransformFile: b.tfm\n", "names another file");
}

TEST_F(ItkText, SaysWhatIsWrongWithTheTransform) {
  const auto affine = [](const char* parameters, const char* fixed) {
    return message("Transform: AffineTransform_double_2_2\nParameters: ", parameters,
                   "\nFixedParameters: ", fixed, "\n");
  };
  expect_error_after_head(affine("1 0 0 1 5", "0 0"),
                          "the AffineTransform_double_2_2 has 5 parameters instead of 6");
  expect_error_after_head(affine("1 0 0 1 5 6", ""), "has 0 fixed parameters instead of 2");
  expect_error_after_head(affine("1 0 nan 1 5 6", "0 0"), "has a parameter that is not finite");
  expect_error_after_head(shift("TranslationTransform_double_3_3", "1 2 3"), "from 3D to 3D");
  expect_error_after_head(shift("TranslationTransform_double_4_4", "1 2 3 4"),
                          "maps neither from 2D to 2D nor from 3D to 3D");
  expect_error_after_head(shift("AzimuthElevationToCartesianTransform_double_3_3", "1"),
                          "the AzimuthElevationToCartesianTransform_double_3_3 is of a class that "
                          "crease has no equal of");
  expect_error_after_head(shift("Euler3DTransform_double_2_2", "1 2 3"), "no equal of");
  expect_error_after_head(shift("TranslationTransform_double_2_2", "1 2") +
                              shift("TranslationTransform_double_2_2", "1 2"),
                          "holds 2 transforms that are no composite");
}

TEST_F(ItkText, SaysWhichPartOfACompositeIsWrong) {
  const std::string composite = "Transform: CompositeTransform_double_2_2\n";
  const std::string good = shift("TranslationTransform_double_2_2", "1 2");
  expect_error_after_head(composite + good + shift("TranslationTransform_double_2_2", "1 2 3"),
                          "transform 2 (TranslationTransform_double_2_2) has 3 parameters");
  expect_error_after_head(
      composite + good + shift("TranslationTransform_double_3_3", "1 2 3"),
      "transform 2 (TranslationTransform_double_3_3) does not map from 2D to 2D");
  expect_error_after_head(composite + composite + good,
                          "transform 1 (CompositeTransform_double_2_2) stands within a list");
}

TEST_F(ItkText, SaysWhatIsWrongWithAGrid) {
  const auto spline = [](const char* fixed, const char* order = "_1") {
    return message("Transform: BSplineTransform_double_2_2", order,
                   "\nParameters: 0 0 0 0 0 0 0 0 0 0 0 0\nFixedParameters: ", fixed, "\n");
  };
  expect_error_after_head(spline("3 2 0 0 1 1 1 0 0"), "has 9 fixed parameters instead of 10");
  expect_error_after_head(spline("3 3 0 0 1 1 1 0 0 1"), "has 12 parameters instead of 18");
  expect_error_after_head(spline("3.5 2 0 0 1 1 1 0 0 1"),
                          "has a grid of 3.5 samples along axis 1");
  expect_error_after_head(spline("1e300 2 0 0 1 1 1 0 0 1"), "has a grid of 1e+300 samples");
  expect_error_after_head(spline("3 2 0 0 1 0 1 0 0 1"), "the spacing of axis 1 is 0");
  expect_error_after_head(spline("3 2 0 0 1 1 1 0.2 0 1"), "lies on a sheared grid");
  expect_error_after_head(spline("3 2 0 0 1 1 1 0 0 1", "_2"),
                          "has a grid of 2 samples along axis 2; one of order 2 needs more than 2");
  expect_error_after_head(spline("3 2 0 0 1 1 1 0 0 1", "_4"), "of another order than 1, 2 or 3");
  const auto field = [](const char* parameters, const char* fixed) {
    return message("Transform: DisplacementFieldTransform_double_2_2\nParameters: ", parameters,
                   "\nFixedParameters: ", fixed, "\n");
  };
  expect_error_after_head(field("0 0 0 0", "2 2 0 0 1 1 1 0 0 1"), "has 4 parameters instead of 8");
  expect_error_after_head(field("0 0 0 inf", "2 1 0 0 1 1 1 0 0 1"), "has inf as parameter 3");
  expect_error_after_head(field("0 0 0 0", "2 1 0 0 1 1 1 1 1 1"), "direction invertible");
  expect_error_after_head(field("", "0 0 0 0 0 0 0 0 0 0"), "has a grid of 0 samples");
}

}  // namespace crease

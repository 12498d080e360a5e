#include "Applications/Report/HtmlReport.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <regex>

#include "Applications/Report/ReportPlaces.h"
#include "Applications/Report/ReportPlanes.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kAttack = R"(</script><script>alert('x')</script><img src="x" onerror='y'>)";

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

auto samples_of(const Image<float, 2>& image) {
  return [&](const Slice<2>& slice) { return samples(image, slice); };
}

ReportStack small_stack(const std::string& name) {
  Raster<2> raster;
  raster.size = {4, 3};
  const ReportPlanes<2> planes(raster);
  const Image<float, 2> black(raster);
  const ReportScale scale = grey_scale(0, 1, name);
  ReportStack stack{
      planes.planes(), {{name, scale, planes.encode(samples_of(black), scale)}}, {}, name};
  stack.overlays.push_back({name, ReportOverlay::Look::kFeature, {{{}}}});
  stack.overlays[0].drawing(0, 0).lines = {{{0, 0}, {1.5, 2}, {3, 2}}};
  stack.overlays[0].drawing(0, 0).marks = {{Point<2>(1, 1), true, name}};
  return stack;
}

/// A report in which each text that a run may put in is `text`.
std::string report_of(const std::string& text) {
  ReportHead head;
  head.command = head.title = text;
  head.status = {ReportMood::kBad, text};
  head.verdict = {{ReportMood::kGood, text}};
  head.figures = {{text, text, text}};
  head.warnings = {text};
  HtmlReport report(head);
  report.begin_section("first", text);
  report.add_text(text);
  report.add_note(text);
  report.add_table({.title = text,
                    .columns = {text, text},
                    .numbers = {1},
                    .rows = {{text, text}},
                    .note = text});
  report.add_code(text, text);
  report.add_plot({.title = text,
                   .x_label = text,
                   .y_label = text,
                   .sections = {{text, 1}},
                   .curves = {{text, {1.0}}}});
  const int stack = report.add_stack(small_stack(text));
  report.add_viewer({.stack = stack,
                     .title = text,
                     .layers = {0},
                     .overlays = {0},
                     .places = {{text, {0}}},
                     .note = text});
  return report.html();
}

TEST(HtmlReport, EscapesWhateverARunPutsIn) {
  const std::string page = report_of(kAttack), plain = report_of("x");
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, Not(HasSubstr("<img")));
  // The same elements, whatever the texts.
  for (const char* tag : {"<script", "</script", "<img", "<td", "<p", "<li"}) {
    EXPECT_EQ(count(page, tag), count(plain, tag)) << tag;
  }
  EXPECT_EQ(escape_html(R"(<a href="b">&'c')"), "&lt;a href=&quot;b&quot;&gt;&amp;&#39;c&#39;");
}

// Names of files may hold any bytes, such as those of another encoding.
TEST(HtmlReport, TakesBytesThatAreNoUtf8) { EXPECT_NO_THROW(report_of("caf\xe9")); }

TEST(HtmlReport, IsOneFileThatNeedsNoNetwork) {
  const std::string page = report_of("x");
  std::string rest = std::regex_replace(page, std::regex("'http://www.w3.org/2000/svg'"), "");
  EXPECT_EQ(count(page, "http://www.w3.org/2000/svg"), 1);
  for (const char* remote :
       {"http:", "https:", "//cdn", "@import", "url(", "<link", "src=\"", "fetch("}) {
    EXPECT_THAT(rest, Not(HasSubstr(remote)));
  }
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, Not(HasSubstr("{{")));
}

TEST(HtmlReport, MarksWhatVariesFromRunToRun) {
  HtmlReport report({});
  report.add_table({.title = "times", .columns = {"t"}, .rows = {{"0.25 s"}}, .varies = true});
  const std::string page = report.html();
  const std::regex varying("<!--varies-->[^]*?<!--/varies-->");
  EXPECT_THAT(page, HasSubstr("0.25 s"));
  EXPECT_THAT(std::regex_replace(page, varying, ""), Not(HasSubstr("0.25 s")));
}

TEST(ReportScale, BytesStandForValuesInEqualStepsOrRatios) {
  ReportScale scale = grey_scale(10, 20, "");
  EXPECT_EQ(scale.byte(std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_EQ(scale.byte(-5), 1);
  EXPECT_EQ(scale.byte(10), 1);
  EXPECT_EQ(scale.byte(15), 128);
  EXPECT_EQ(scale.byte(20), 255);
  EXPECT_EQ(scale.byte(99), 255);
  scale.lower = 0.5;
  scale.upper = 2;
  scale.logarithmic = true;
  scale.first = 2;
  EXPECT_EQ(scale.byte(-0.1), 1);  // special
  EXPECT_EQ(scale.byte(0.1), 2);
  EXPECT_NEAR(scale.byte(1), 0.5 * (2 + 255), 0.5);
}

TEST(ReportPlanes, SmallImagesAreShownWhole) {
  Raster<2> raster;
  raster.size = {300, 200};
  raster.spacing = {0.5, 2};
  raster.origin = {-7, 11};
  const ReportPlanes<2> planes(raster);
  const ReportPlane plane = planes.planes().at(0);
  EXPECT_EQ(plane.width, 300);
  EXPECT_EQ(plane.height, 200);
  EXPECT_EQ(plane.width_mm, 150);
  EXPECT_EQ(plane.height_mm, 400);
  EXPECT_EQ(planes.note(), "");
  const Point<2> point = raster.point({41.25, 3});
  const auto spot = planes.spot(0, point);
  ASSERT_TRUE(spot);
  EXPECT_LT((spot->pixel - Point<2>(41.25, 3)).norm(), 1e-9);
  EXPECT_FALSE(planes.spot(0, raster.point({-0.6, 3})));
}

// What the page computes from origin and steps is where the slice's pixels are, flipped planes too.
TEST(ReportPlanes, PlacesOfPixelsAgreeWithPoints) {
  Raster<3> raster;
  raster.size = {700, 300, 90};
  raster.spacing = {0.5, 0.75, 3};
  raster.origin = {5, -6, 7};
  raster.direction << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const ReportPlanes<3> planes(raster);
  const Point<3> point = raster.point({433.2, 71.9, 40.4});
  for (int p = 0; p < 3; ++p) {
    const ReportPlane plane = planes.planes()[static_cast<std::size_t>(p)];
    const auto spot = planes.spot(p, point);
    ASSERT_TRUE(spot);
    const auto& origin = plane.slices[static_cast<std::size_t>(spot->slice)].origin_mm;
    Vector<3> there;
    for (std::size_t a = 0; a < 3; ++a) {
      there[static_cast<Eigen::Index>(a)] =
          origin[a] + spot->pixel.x() * plane.right_mm[a] + spot->pixel.y() * plane.down_mm[a];
    }
    // but for the distance to the nearest slice
    const Vector<3> apart = raster.index(there) - raster.index(point);
    EXPECT_LT(apart.cwiseAbs().minCoeff(), 1e-9);
    int off_plane = 0;
    for (int a = 0; a < 3; ++a) off_plane += std::abs(apart[a]) > 1e-6;
    EXPECT_LE(off_plane, 1) << plane.name;
  }
}

TEST(ReportPlanes, LargeVolumesStayWithinTheirBytesAndSaySo) {
  for (const auto& size : {std::array<int, 3>{512, 512, 300}, std::array<int, 3>{64, 64, 2000}}) {
    Raster<3> raster;
    raster.size = size;
    const ReportPlanes<3> planes(raster);
    double pixels = 0;
    for (const auto& plane : planes.planes()) {
      pixels += double(plane.width) * plane.height * static_cast<double>(plane.slices.size());
      EXPECT_GE(plane.slices.size(), 15u);
    }
    EXPECT_LT(pixels, 1.2e6);
    EXPECT_GT(pixels, 0.8e6);
    EXPECT_THAT(planes.note(), HasSubstr("slices"));
    EXPECT_THAT(planes.note(), HasSubstr("%"));
  }
}

TEST(ReportPlanes, ShrunkPixelsKeepASingleFold) {
  Raster<2> raster;
  raster.size = {3000, 2000};
  Image<float, 2> image(raster, 1.0f);
  image(1234, 777) = -1;
  const ReportPlanes<2> planes(raster);
  ReportScale scale = grey_scale(0.5, 2, "");
  scale.first = 2;
  scale.logarithmic = true;
  const std::string folded = planes.encode(samples_of(image), scale).at(0);
  image(1234, 777) = 1;
  EXPECT_NE(folded, planes.encode(samples_of(image), scale).at(0));
}

TEST(ReportPlaces, FindsTheExtremesApartFromEachOther) {
  Raster<2> raster;
  raster.size = {120, 60};
  Image<float, 2> image(raster, 1.0f);
  image(10, 10) = -3;
  image(12, 10) = -2;  // too near to the first
  image(80, 40) = -1;
  image(50, 50) = -9;  // not in the mask
  Mask<2> mask(raster, 1);
  mask(50, 50) = 0;
  const auto found = extremes(image, mask, false, 2);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].at, Point<2>(10, 10));
  EXPECT_EQ(found[0].value, -3);
  EXPECT_EQ(found[1].at, Point<2>(80, 40));
  EXPECT_EQ(extremes(image, mask, true, 1).front().value, 1);
}

}  // namespace
}  // namespace crease

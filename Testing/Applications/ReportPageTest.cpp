// report.html in a real browser, without a display: what a user does, and what the page makes of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "Images/ImageFile.h"
#include "Registration/Phantoms/Phantom.h"
#include "Testing/Applications/Browser.h"
#include "Testing/Applications/CommandRunner.h"

namespace crease {
namespace {

using testing::Browser;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::run_crease;

class ReportPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (Browser::program().empty()) {
      GTEST_SKIP() << "no chromium is installed (cmake/install-packages.sh does it)";
    }
  }

  /// `crease register` of two images; @return its report.
  std::filesystem::path report(const std::string& fixed, const std::string& moving,
                               const std::vector<std::string>& extra) const {
    std::vector<std::string> arguments = {"register", "--fixed", fixed,    "--moving", moving,
                                          "--output", output(),  "--init", "identity", "--quiet"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const auto run = run_crease(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return folder / "out/report.html";
  }
  std::string output() const { return (folder / "out").string(); }

  testing::TemporaryFolder folder;
};

/// Where the first viewer's divider stands, in percent.
double divider(Browser& browser) {
  return std::stod(
      browser.evaluate("document.querySelector('.divider').style.left").get<std::string>());
}

std::string selected_tab(Browser& browser) {
  return browser.evaluate("document.querySelector('[role=tab][aria-selected=true]').textContent");
}

/// Red, green and blue in the middle of a canvas.
std::vector<int> middle_pixel(Browser& browser, const std::string& canvas) {
  return browser.evaluate("(() => { const c = " + canvas +
                          "; return [...c.getContext('2d').getImageData(c.width >> 1, c.height >> "
                          "1, 1, 1).data].slice(0, 3); })()");
}

const std::string kPainted =
    "[...document.querySelectorAll('.panel:not([hidden]) .sheet canvas')].every((c) => c.width > 0 "
    "&& "
    "c.getContext('2d').getImageData(c.width >> 1, c.height >> 1, 1, 1).data[3] === 255)";
const std::string kFocusStage = "document.querySelector('.panel:not([hidden]) .stage').focus()";

TEST_F(ReportPage, ComparesImagesByMouseAndKeys) {
  // A name that would be a script, were it not escaped.
  const std::string name = R"(a'"><img src=x onerror=window.broken=1>&amp;.mha)";
  const Phantom phantom = make_phantom("spine", {.size = 96});
  write_image(folder / "fixed.mha", phantom.fixed, PixelType::kFloat);
  write_image(folder / name, phantom.moving, PixelType::kFloat);
  write_labels(folder / "labels.mha", phantom.labels);
  const auto page =
      report((folder / "fixed.mha").string(), (folder / name).string(),
             {"--rigid-labels", (folder / "labels.mha").string(), "--mesh-size", "24"});
  Browser browser;
  browser.open(page, 1280, 900);
  EXPECT_EQ(browser.evaluate("document.querySelector('h1').textContent"),
            name + " registered to fixed.mha");
  EXPECT_EQ(browser.evaluate("typeof window.broken"), "undefined");
  ASSERT_TRUE(browser.becomes_true(kPainted));

  // The divider follows arrow keys, its slider and the mouse, and the upper picture is cut there.
  EXPECT_EQ(divider(browser), 50);
  browser.evaluate(kFocusStage);
  browser.press("ArrowRight");
  EXPECT_EQ(divider(browser), 51);
  browser.evaluate("document.querySelector('.bar input[type=range]').focus()");
  browser.press("Home");
  EXPECT_EQ(divider(browser), 0);
  const auto box = browser.evaluate(
      "(() => { scrollTo(0, 400); const b = "
      "document.querySelector('.sheet').getBoundingClientRect();"
      " return [b.left, b.top, b.width, b.height]; })()");
  const double left = box[0], top = box[1], width = box[2], height = box[3];
  browser.drag(left + 0.5 * width, top + 0.3 * height, left + 0.25 * width, top + 0.4 * height);
  EXPECT_NEAR(divider(browser), 25, 0.6);
  EXPECT_THAT(browser.evaluate("document.querySelectorAll('.sheet canvas')[1].style.clipPath")
                  .get<std::string>(),
              ::testing::MatchesRegex("inset\\(0(px)? 0(px)? 0(px)? 2[45].*%\\)"));
  EXPECT_THAT(browser.evaluate("document.querySelector('.readout').textContent").get<std::string>(),
              ::testing::ContainsRegex("mm.*fixed .*warped "));

  // Space flickers by hand; the figures choose the ways; half of the checkerboard is warped.
  browser.evaluate(kFocusStage);
  const std::string shown =
      "[...document.querySelectorAll('.panel:not([hidden]) .sheet canvas')].map((c) => "
      "c.style.visibility)";
  browser.press(" ");
  const auto first = browser.evaluate(shown);
  browser.press(" ");
  EXPECT_NE(browser.evaluate(shown), first);
  browser.press("4");
  EXPECT_EQ(browser.evaluate("document.querySelector('.modes :checked').value"), "checkerboard");
  EXPECT_TRUE(browser.becomes_true(
      "(() => { const [a, b] = [...document.querySelectorAll('.sheet canvas')].map((c) => "
      "c.getContext('2d').getImageData(0, 0, c.width, c.height).data); let same = 0; for (let i = "
      "0; "
      "i < a.length; i += 4) same += a[i] === b[i] && a[i + 3] === b[i + 3]; const share = 4 * "
      "same / "
      "a.length; return share > 0.5 && share < 0.8; })()"));
  EXPECT_THAT(browser.problems(), IsEmpty());
}

TEST_F(ReportPage, TabsThemesAndNarrowWindowsWork) {
  const Phantom phantom = make_phantom("spine", {.size = 96});
  write_image(folder / "fixed.mha", phantom.fixed, PixelType::kFloat);
  write_image(folder / "moving.mha", phantom.moving, PixelType::kFloat);
  write_labels(folder / "labels.mha", phantom.labels);
  const auto page =
      report((folder / "fixed.mha").string(), (folder / "moving.mha").string(),
             {"--rigid-labels", (folder / "labels.mha").string(), "--mesh-size", "24"});
  Browser browser;
  browser.open(page, 390, 800);

  // Every tab by the arrow key, its pictures painted, nothing wider than the window.
  std::vector<std::string> seen = {selected_tab(browser)};
  browser.evaluate("document.querySelector('[role=tab][aria-selected=true]').focus()");
  for (int tab = 1; tab < 7; ++tab) {
    browser.press("ArrowRight");
    seen.push_back(selected_tab(browser));
    EXPECT_TRUE(browser.becomes_true(kPainted)) << seen.back();
    EXPECT_EQ(browser.evaluate("document.documentElement.scrollWidth"), 390) << seen.back();
    EXPECT_EQ(browser.evaluate("document.querySelectorAll('.panel:not([hidden])').length"), 1);
  }
  EXPECT_THAT(seen, ElementsAre("Compare", "Difference", "Deformation", "Jacobian and strain",
                                "Optimisation", "Landmarks and bodies", "Run"));
  EXPECT_EQ(browser.evaluate("location.hash"), "#run");
  EXPECT_GT(browser.evaluate("document.querySelectorAll('.plot path.curve').length").get<int>(), 2);
  EXPECT_GT(
      browser.evaluate("document.querySelector('#deformation .sheet .line-grid').getTotalLength()")
          .get<double>(),
      1000.0);
  browser.press("Home");
  EXPECT_EQ(selected_tab(browser), "Compare");

  // The system's theme, until another is chosen.
  const std::string paper = "getComputedStyle(document.body).backgroundColor";
  const auto light = browser.evaluate(paper);
  browser.prefer("dark");
  EXPECT_TRUE(browser.becomes_true(paper + " !== '" + light.get<std::string>() + "'"));
  browser.evaluate("document.querySelector('#theme').click()");  // light
  EXPECT_EQ(browser.evaluate(paper), light);
  browser.evaluate("document.querySelector('#theme').click()");  // dark
  EXPECT_NE(browser.evaluate(paper), light);
  EXPECT_THAT(browser.problems(), IsEmpty());
}

/// A volume whose slice k is k + 1 throughout, but for a bright ball.
Image<float, 3> layered_volume(double shift) {
  Raster<3> raster;
  raster.size = {20, 24, 16};
  Image<float, 3> image(raster);
  for (std::int64_t n = 0; n < raster.num_samples(); ++n) {
    const auto [i, j, k] = image.index(n);
    const double ball = std::hypot(i - 9 - shift, j - 12, k - 8);
    image.values()[static_cast<std::size_t>(n)] =
        static_cast<float>(k + 1 + 20 * std::exp(-ball * ball / 18));
  }
  return image;
}

TEST_F(ReportPage, LeafsThroughVolumes) {
  write_image(folder / "fixed.mha", layered_volume(0), PixelType::kFloat);
  write_image(folder / "moving.mha", layered_volume(0.7), PixelType::kFloat);
  const auto page = report((folder / "fixed.mha").string(), (folder / "moving.mha").string(),
                           {"--transform", "bspline", "--mesh-size", "12", "--levels", "1"});
  Browser browser;
  browser.open(page, 1000, 800);
  ASSERT_TRUE(browser.becomes_true(kPainted));
  const std::string slice =
      "[...document.querySelectorAll('output')].map((o) => o.textContent).find((t) => "
      "t.includes('slice'))";
  EXPECT_EQ(browser.evaluate(slice), "slice 9 of 16, z = 8.0 mm");
  browser.evaluate(kFocusStage);
  const std::string canvas = "document.querySelector('.sheet canvas')";
  for (int press = 0; press < 20; ++press) browser.press("PageDown");
  EXPECT_EQ(browser.evaluate(slice), "slice 16 of 16, z = 15.0 mm");
  for (int press = 0; press < 15; ++press) browser.press("PageUp");
  EXPECT_EQ(browser.evaluate(slice), "slice 1 of 16, z = 0.0 mm");
  // The lowest slice is the darkest; the ball's is bright.
  ASSERT_TRUE(
      browser.becomes_true(canvas + ".getContext('2d').getImageData(10, 12, 1, 1).data[0] < 40"));
  EXPECT_LT(middle_pixel(browser, canvas)[0], 40);
  browser.evaluate(
      "[...document.querySelectorAll('.modes label')].find((l) => l.textContent === "
      "'sagittal').querySelector('input').click()");
  EXPECT_EQ(browser.evaluate(slice), "slice 11 of 20, x = 10.0 mm");
  EXPECT_TRUE(browser.becomes_true(canvas + ".width === 24 && " + canvas + ".height === 16 && " +
                                   canvas +
                                   ".getContext('2d').getImageData(12, 7, 1, 1).data[0] > 200"));
  EXPECT_THAT(browser.problems(), IsEmpty());
}

// Mutual information is a negative energy: its curve, and the sum's, lie within the plot all the same.
TEST_F(ReportPage, PlotsNegativeEnergies) {
  const Phantom phantom = make_phantom("blobs", {.size = 64});
  write_image(folder / "fixed.mha", phantom.fixed, PixelType::kFloat);
  write_image(folder / "moving.mha", phantom.moving, PixelType::kFloat);
  const auto page = report((folder / "fixed.mha").string(), (folder / "moving.mha").string(),
                           {"--metric", "mi", "--mesh-size", "24"});
  Browser browser;
  browser.open(page, 1000, 800);
  browser.evaluate("location.hash = '#optimisation'");
  ASSERT_TRUE(browser.becomes_true("document.querySelectorAll('.plot svg path.curve').length > 0"));
  const auto outside = browser.evaluate(
      "(() => { const box = document.querySelector('.plot > svg').getBoundingClientRect(); "
      "return [...document.querySelectorAll('.plot > svg path.curve')].filter((p) => { const b = "
      "p.getBoundingClientRect(); return !(b.top >= box.top && b.bottom <= box.bottom && b.width > "
      "0); }).length; })()");
  EXPECT_EQ(outside, 0);
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('.plot > svg path.curve').length"), 3);
  EXPECT_EQ(browser.evaluate("document.querySelector('.plot input').disabled"), true);
  EXPECT_THAT(browser.problems(), IsEmpty());
}

}  // namespace
}  // namespace crease

#include "Registration/Mammogram/MammogramPictures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "Core/Error.h"
#include "Registration/PicturesCanvas.h"
#include "Registration/PicturesLines.h"
#include "Registration/PicturesSlices.h"
#include "Transforms/Domains/RegionOfInterest.h"

namespace crease {
namespace {

using canvas::Colour;

constexpr Colour kMask{80, 160, 255}, kSkin{255, 220, 60}, kNipple{255, 60, 170},
    kPectoral{255, 140, 0}, kPoint{90, 230, 120};

Picture panel_of(const AnatomyPanel& panel) {
  const MammogramAnatomy& anatomy = *panel.anatomy;
  const Image<float, 2>& image = anatomy.frame.image;
  const Slice<2> slice = slices(image.raster()).front();
  Picture picture = dimmed_panel(image, slice);
  const auto pixel = [&](const Point<2>& p) { return slice.pixel(image.raster().index(p)); };
  const auto draw = [&](const Polyline& line, bool closed, Colour colour, int width) {
    Polyline pixels;
    for (const auto& p : line) pixels.push_back(pixel(p));
    canvas::draw_polyline(picture, pixels, closed, colour, width);
  };
  const RegionOfInterest mask = region_of_mask(image.raster(), anatomy.breast.mask.values());
  for (const auto& ring : mask.rings()) draw(ring, true, kMask, 1);
  draw(anatomy.skin.points, false, kSkin, 2);
  if (anatomy.pectoral) draw(anatomy.pectoral->line, false, kPectoral, 2);
  for (const auto& p : panel.points) canvas::draw_ring(picture, pixel(p), 4, kPoint, 1);
  if (anatomy.skin.nipple) {
    canvas::draw_ring(picture, pixel(anatomy.skin.nipple->point), 9, kNipple, 2);
  }
  return picture;
}

}  // namespace

Picture overlay_contours(const std::vector<AnatomyPanel>& panels) {
  if (panels.empty()) throw InvalidInput("overlay_contours: there is nothing to draw.");
  canvas::Legend legend;
  legend.swatches = {{kMask, "mask"}, {kSkin, "skin line"}};
  const auto any = [&](const auto& has) { return std::any_of(panels.begin(), panels.end(), has); };
  if (any([](const AnatomyPanel& p) { return p.anatomy->skin.nipple.has_value(); })) {
    legend.swatches.emplace_back(kNipple, "nipple");
  }
  if (any([](const AnatomyPanel& p) { return p.anatomy->pectoral.has_value(); })) {
    legend.swatches.emplace_back(kPectoral, "pectoral");
  }
  if (any([](const AnatomyPanel& p) { return !p.points.empty(); })) {
    legend.swatches.emplace_back(kPoint, "pairs");
  }
  std::vector<std::pair<std::string, Picture>> pictures;
  for (const auto& panel : panels) pictures.emplace_back(panel.title, panel_of(panel));
  return canvas::framed(pictures, legend, {});
}

Picture histogram_picture(const GreyHistogram& histogram) {
  constexpr int kBin = 3, kHeight = 300;
  const int width = kBin * GreyHistogram::kBins;
  Picture picture = canvas::blank(width, kHeight, canvas::kPaper);
  const double highest =
      std::max(1.0, *std::max_element(histogram.smoothed.begin(), histogram.smoothed.end()));
  const auto y = [&](double l) { return (kHeight - 12) * (1 - l / highest) + 6; };
  Polyline curve;
  for (int t = 0; t < GreyHistogram::kBins; ++t) {
    curve.emplace_back(kBin * (t + 0.5), y(histogram.smoothed[static_cast<std::size_t>(t)]));
  }
  canvas::Legend legend;
  const auto mark = [&](double t, Colour colour, const std::string& text) {
    const std::array<Point<2>, 2> line = {Point<2>(kBin * (t + 0.5), 0),
                                          Point<2>(kBin * (t + 0.5), kHeight - 1)};
    canvas::draw_polyline(picture, line, false, colour, 1);
    legend.swatches.emplace_back(colour,
                                 message(text, " ", std::round(histogram.grey_value(t - 0.5))));
  };
  mark(histogram.background, kMask, "background");
  mark(histogram.otsu, kPectoral, "Otsu");
  if (histogram.valley) mark(*histogram.valley, kNipple, "valley");
  canvas::draw_polyline(picture, curve, false, canvas::kInk, 1);
  return canvas::framed({{"ln(1 + number of pixels) over grey value", picture}}, legend, {});
}

}  // namespace crease

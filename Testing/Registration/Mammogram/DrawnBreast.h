#pragma once

#include <cstdint>

#include "Images/Image.h"
#include "Transforms/Domains/Polygon.h"

namespace crease::testing {

/// What is drawn: a breast on a film, the chest wall at the left edge.
struct DrawnBreastOptions {
  int width = 560, height = 700;  ///< pixels of 0.2 mm
  double noise = 0.004;           ///< deviation, grey values run from 0 to 1
  bool nipple = true;
  bool pectoral = false;
  bool label = true;  ///< two bright rectangles away from the breast
  std::uint64_t seed = 1;
};

/// A film with grey values from about 0 to 1, and the truth.
struct DrawnBreast {
  Image<float, 2> image;
  Mask<2> mask;
  Polyline outline;   ///< from the upper end at the chest wall to the lower one, mm
  Point<2> nipple;    ///< mm
  Polyline pectoral;  ///< from its upper end to the chest wall, mm
};

/// Half a superellipse of 75 x 52 mm with a nipple 4 mm high, darker towards the skin, gland in the middle.
DrawnBreast draw_breast(const DrawnBreastOptions& options = {});

/// 2 |A and B| / (|A| + |B|).
double dice(const Mask<2>& a, const Mask<2>& b);

/// The image left to right.
template <typename Pixel>
Image<Pixel, 2> flipped(const Image<Pixel, 2>& image) {
  Image<Pixel, 2> result(image.raster());
  const auto [width, height] = image.size();
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) result(i, j) = image(width - 1 - i, j);
  }
  return result;
}

/// round(v * largest), kept within 0 .. largest: an image of 8, 12 or 16 bits.
Image<float, 2> quantized(const Image<float, 2>& image, int largest);

/// largest - v.
Image<float, 2> negative(const Image<float, 2>& image, float largest);

/// Mean distance of the points from a polyline.
double mean_distance(const Polyline& points, const Polyline& line);

}  // namespace crease::testing

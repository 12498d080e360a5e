#include "Testing/Registration/Mammogram/DrawnBreast.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Registration/Phantoms/Random.h"

namespace crease::testing {
namespace {

constexpr double kPixel = 0.2, kNippleAngle = -0.05;
constexpr double kAcross = 75, kUp = 52;  // half axes, mm
constexpr double kPectoralAcross = 38,
                 kPectoralDown = 80;  // where its line cuts the axes from the corner, mm

/// Radius of the outline in a direction about the middle of the chest wall, mm.
double radius(double angle, bool nipple) {
  const double r = std::pow(
      std::pow(std::cos(angle) / kAcross, 2.2) + std::pow(std::abs(std::sin(angle)) / kUp, 2.2),
      -1 / 2.2);
  const double d = (angle - kNippleAngle) / 0.045;
  return r + (nipple ? 4 * std::exp(-d * d) : 0.0);
}

double in_gland(double x, double y) {
  const double a = (x - 38) / 25, b = y / 26;
  return std::exp(-std::pow(a * a + b * b, 1.5));
}

/// How far a point lies within the muscle, mm; negative outside.
double depth_in_muscle(double x, double y_from_top) {
  const double slope = std::hypot(1 / kPectoralAcross, 1 / kPectoralDown);
  return (1 - x / kPectoralAcross - y_from_top / kPectoralDown) / slope;
}

}  // namespace

DrawnBreast draw_breast(const DrawnBreastOptions& options) {
  Raster<2> raster;
  raster.size = {options.width, options.height};
  raster.spacing.setConstant(kPixel);
  DrawnBreast drawn{Image<float, 2>(raster), Mask<2>(raster), {}, {}, {}};
  const double middle = 0.5 * options.height * kPixel, top = middle - kUp;
  Random random(options.seed, 1);
  for (int j = 0; j < options.height; ++j) {
    for (int i = 0; i < options.width; ++i) {
      const double x = i * kPixel, y = j * kPixel - middle;
      const double depth = radius(std::atan2(y, x), options.nipple) - std::hypot(x, y);
      double grey = 0.02 + 0.008 * j / options.height;
      if (depth > 0) {
        const double d = std::min(1.0, depth / 16);
        const double thickness = std::sqrt(1 - (1 - d) * (1 - d));
        grey += thickness *
                (0.34 + 0.2 * in_gland(x, y) + 0.02 * std::sin(0.9 * x) * std::cos(0.7 * y));
        if (options.pectoral) {
          const double muscle = depth_in_muscle(x, j * kPixel - top);
          grey += 0.22 * thickness / (1 + std::exp(-4 * muscle));
        }
        drawn.mask(i, j) = 1;
      }
      const int from_right = options.width - i;
      const bool plate = from_right > 60 && from_right < 180 && j > 40 && j < 80;
      const bool strip = from_right > 60 && from_right < 100 && j > 110 && j < 130;
      if (options.label && (plate || strip)) grey = 0.95;
      drawn.image(i, j) =
          static_cast<float>(std::clamp(grey + options.noise * random.normal(), 0.0, 1.0));
    }
  }
  for (int k = 0; k <= 2000; ++k) {
    const double angle = std::numbers::pi * (k / 2000.0 - 0.5);
    const double r = radius(angle, options.nipple);
    drawn.outline.emplace_back(r * std::cos(angle), middle + r * std::sin(angle));
  }
  const double r = radius(kNippleAngle, options.nipple);
  drawn.nipple = {r * std::cos(kNippleAngle), middle + r * std::sin(kNippleAngle)};
  drawn.pectoral = {{kPectoralAcross, top}, {0, top + kPectoralDown}};
  return drawn;
}

double dice(const Mask<2>& a, const Mask<2>& b) {
  std::int64_t both = 0, sum = 0;
  for (std::size_t i = 0; i < a.values().size(); ++i) {
    const int in_a = a.values()[i] != 0, in_b = b.values()[i] != 0;
    both += in_a & in_b;
    sum += in_a + in_b;
  }
  return 2.0 * static_cast<double>(both) / static_cast<double>(sum);
}

Image<float, 2> quantized(const Image<float, 2>& image, int largest) {
  Image<float, 2> result = image;
  for (float& v : result.values()) {
    v = std::round(std::clamp(v, 0.0f, 1.0f) * static_cast<float>(largest));
  }
  return result;
}

Image<float, 2> negative(const Image<float, 2>& image, float largest) {
  Image<float, 2> result = image;
  for (float& v : result.values()) v = largest - v;
  return result;
}

double mean_distance(const Polyline& points, const Polyline& line) {
  double sum = 0;
  for (const auto& p : points) sum += distance_to_polyline(line, false, p);
  return sum / static_cast<double>(points.size());
}

}  // namespace crease::testing

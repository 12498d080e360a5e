#include "Registration/Mammogram/PectoralMuscle.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "Core/Error.h"
#include "Images/OpenCvView.h"
#include "Registration/Mammogram/PectoralEdge.h"
#include "Transforms/Splines/SplineCurve.h"

namespace crease {
namespace {

using pectoral::holds;
using pectoral::value_at;
using pectoral::View;

/// Pixels of the raster to those of the view, and back.
Point<2> turned(const Point<2>& p, ChestSide side, int width) {
  return side == ChestSide::kLeft ? p : Point<2>(width - 1 - p.x(), p.y());
}

View make_view(const Image<float, 2>& image, const BreastSegmentation& breast,
               const PectoralOptions& options) {
  const Raster<2> pixels{.size = image.size()};
  View view;
  view.grey = view.gx = view.gy = Image<float, 2>(pixels);
  view.breast = view.allowed = Mask<2>(pixels);
  view.pixel_mm = image.raster().spacing.minCoeff();
  double lower = breast.histogram.lower, upper = breast.histogram.upper;
  if (!(upper > lower)) cv::minMaxLoc(opencv_view(image), &lower, &upper);
  const double scale = upper > lower ? 255 / (upper - lower) : 1.0;
  cv::Mat grey = opencv_view(view.grey), inside = opencv_view(view.breast);
  opencv_view(image).convertTo(grey, CV_32F, scale, -lower * scale);
  opencv_view(breast.mask).copyTo(inside);
  if (breast.side == ChestSide::kRight) {
    cv::flip(grey, grey, 1);
    cv::flip(inside, inside, 1);
  }
  const double sigma = options.edge_blur_mm / view.pixel_mm;
  cv::GaussianBlur(grey, grey, {0, 0}, sigma, sigma, cv::BORDER_REPLICATE);
  cv::Sobel(grey, opencv_view(view.gx), CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(grey, opencv_view(view.gy), CV_32F, 0, 1, 3, 0.125);
  cv::Mat distance;
  cv::distanceTransform(inside, distance, cv::DIST_L2, cv::DIST_MASK_5);
  cv::Mat((distance > options.skin_margin_mm / view.pixel_mm) & 1)
      .copyTo(opencv_view(view.allowed));
  return view;
}

/// The grey values on one side of a piece of the line.
struct Band {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double mean() const { return sum / count; }
  /// Sum of squared deviations from the mean.
  double deviations() const { return squares - sum * sum / count; }
};

/// PectoralMuscle::contrast; 0 where no two places beside the line lie in the breast. Both sides are measured piece
/// by piece, so that greys that change along the line do not count as noise.
double contrast_along(const View& view, const Polyline& line, const PectoralOptions& options) {
  constexpr double kPiece = 10;  // mm
  const int near = static_cast<int>(std::ceil(options.band_near_mm / view.pixel_mm));
  const int far = static_cast<int>(std::floor(options.band_far_mm / view.pixel_mm));
  const int count = std::max(2, static_cast<int>(polyline_length(line, false)));
  const Polyline points = resample_polyline(line, false, count);
  const auto per_piece = std::max<std::size_t>(2, std::lround(kPiece / view.pixel_mm));
  double difference = 0, deviations = 0;
  int samples = 0, degrees = 0;
  for (std::size_t first = 1; first < points.size(); first += per_piece) {
    Band bright, dark;
    for (std::size_t i = first; i < std::min(points.size(), first + per_piece); ++i) {
      const Vector<2> along = (points[i] - points[i - 1]).normalized();
      const Vector<2> away(along.y(), -along.x());  // from the corner, for lines that go down
      for (int k = near; k <= far; ++k) {
        const Point<2> inner = points[i] - k * away, outer = points[i] + k * away;
        if (!holds(view.allowed, inner) || !holds(view.allowed, outer)) continue;
        bright.add(value_at(view.grey, inner));
        dark.add(value_at(view.grey, outer));
      }
    }
    if (bright.count < 2) continue;
    difference += bright.count * (bright.mean() - dark.mean());
    deviations += bright.deviations() + dark.deviations();
    samples += bright.count;
    degrees += bright.count + dark.count - 2;
  }
  if (samples == 0 || !(deviations > 0)) return 0;
  return difference / samples / std::sqrt(deviations / degrees);
}

/// The longest stretch of points that lie in the mask.
Polyline longest_inside(const Mask<2>& mask, const Polyline& points) {
  Polyline best, run;
  for (const auto& p : points) {
    if (holds(mask, p)) {
      run.push_back(p);
      if (run.size() > best.size()) best = run;
    } else {
      run.clear();
    }
  }
  return best;
}

/// Goes on straight from a point of the breast to the last one before the border.
Point<2> at_border(const View& view, Point<2> p, const Vector<2>& direction) {
  constexpr double kStep = 0.25;
  while (holds(view.breast, p + kStep * direction)) p += kStep * direction;
  return p;
}

/// The spline's points, a point per 2 mm, continued to the border of the breast at both ends.
Polyline smoothed(const View& view, const Polyline& path, const PectoralOptions& options) {
  const SplineCurve curve = fit_curve_within(path, options.smoothing_mm / view.pixel_mm).curve;
  const int count = std::max(4, static_cast<int>(curve.length() * view.pixel_mm / 2));
  Polyline points = equal_arc_points(curve, count);
  const Polyline inside = longest_inside(view.breast, points);
  if (inside.size() < 2) return {};
  points = inside;
  // Directions over a centimetre: the spline's own at its ends follow the last few pixels.
  const auto back = std::min<std::size_t>(points.size() - 1, 5);
  const Vector<2> up = (points.front() - points[back]).normalized();
  const Vector<2> down = (points.back() - points[points.size() - 1 - back]).normalized();
  const Point<2> upper = at_border(view, points.front(), up);
  const Point<2> lower = at_border(view, points.back(), down);
  if (upper != points.front()) points.insert(points.begin(), upper);
  if (lower != points.back()) points.push_back(lower);
  return points;
}

}  // namespace

std::optional<PectoralMuscle> find_pectoral_muscle(const Image<float, 2>& image,
                                                   const BreastSegmentation& breast,
                                                   const PectoralOptions& options) {
  const View view = make_view(image, breast, options);
  const auto straight = pectoral::best_straight_line(view, options);
  if (!straight) return std::nullopt;
  const Polyline path =
      longest_inside(view.allowed, pectoral::cheapest_path(view, *straight, options));
  if (static_cast<double>(path.size()) * view.pixel_mm < options.shortest_mm) return std::nullopt;
  const Polyline line = smoothed(view, path, options);
  if (line.empty()) return std::nullopt;
  PectoralMuscle muscle;
  muscle.contrast = contrast_along(view, line, options);
  if (muscle.contrast < options.smallest_contrast) return std::nullopt;
  for (const auto& p : line) {
    muscle.line.push_back(image.raster().point(turned(p, breast.side, image.size()[0])));
  }
  return muscle;
}

PectoralMuscle pectoral_muscle_of(Polyline line, const Image<float, 2>& image,
                                  const BreastSegmentation& breast,
                                  const PectoralOptions& options) {
  const View view = make_view(image, breast, options);
  if (line.size() < 2) throw InvalidInput("the pectoral line needs at least 2 points.");
  Polyline pixels;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (!line[i].allFinite()) {
      throw InvalidInput(message("the pectoral line: point ", i + 1, " is not finite."));
    }
    pixels.push_back(turned(image.raster().index(line[i]), breast.side, image.size()[0]));
  }
  if (pixels.front().y() > pixels.back().y()) {
    std::reverse(pixels.begin(), pixels.end());
    std::reverse(line.begin(), line.end());
  }
  const bool somewhere = std::any_of(pixels.begin(), pixels.end(),
                                     [&](const Point<2>& p) { return holds(view.breast, p); });
  if (!somewhere) throw InvalidInput("the pectoral line: none of its points lies in the breast.");
  return {std::move(line), contrast_along(view, pixels, options), true};
}

}  // namespace crease

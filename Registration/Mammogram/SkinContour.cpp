#include "Registration/Mammogram/SkinContour.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <span>

#include "Core/Error.h"
#include "Core/Quantiles.h"
#include "Images/OpenCvView.h"
#include "Transforms/Splines/SplineCurve.h"

namespace crease {
namespace {

/// Border pixels of the mask's largest component, 8-connected, in order, the first not repeated.
std::vector<cv::Point> border_pixels(const Mask<2>& mask) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(opencv_view(mask), contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  const auto largest =
      std::max_element(contours.begin(), contours.end(),
                       [](const auto& a, const auto& b) { return a.size() < b.size(); });
  return largest == contours.end() ? std::vector<cv::Point>{} : *largest;
}

/// A run of a ring of pixels: `count` of them from `first`.
struct Run {
  std::size_t first = 0, count = 0;
};

/// The longest run of the ring that satisfies the predicate.
template <typename Predicate>
Run longest_run(const std::vector<cv::Point>& ring, const Predicate& holds) {
  const std::size_t n = ring.size();
  std::size_t start = 0;
  while (start < n && holds(ring[start])) ++start;
  if (start == n) return {0, n};
  Run best, run;
  for (std::size_t k = 1; k <= n; ++k) {
    const std::size_t i = (start + k) % n;
    if (holds(ring[i])) {
      if (run.count == 0) run.first = i;
      ++run.count;
      if (run.count > best.count) best = run;
    } else {
      run = {};
    }
  }
  return best;
}

std::vector<cv::Point> part(const std::vector<cv::Point>& ring, const Run& run) {
  std::vector<cv::Point> pixels;
  for (std::size_t k = 0; k < run.count; ++k) pixels.push_back(ring[(run.first + k) % ring.size()]);
  return pixels;
}

/// Border pixels lie inside the border: their centres are moved outwards on to it, by half a pixel where it runs
/// along an axis and by less where it is slanted.
Polyline on_border(const Polyline& pixels, bool outside_on_left) {
  constexpr std::ptrdiff_t kReach = 4;  // for the direction
  Polyline points = pixels;
  const std::ptrdiff_t last = std::ssize(pixels) - 1;
  for (std::ptrdiff_t i = 0; i <= last; ++i) {
    const Vector<2> along =
        pixels[std::min(last, i + kReach)] - pixels[std::max<std::ptrdiff_t>(0, i - kReach)];
    if (!(along.norm() > 0)) continue;
    const Vector<2> left = turned_left(along.normalized());
    points[i] += (outside_on_left ? 0.5 : -0.5) * left.cwiseAbs().maxCoeff() * left;
  }
  return points;
}

Polyline as_points(const std::vector<cv::Point>& pixels) {
  Polyline points;
  for (const auto& p : pixels) points.emplace_back(p.x, p.y);
  return points;
}

Polyline in_mm(Polyline points, const Raster<2>& raster) {
  for (auto& p : points) p = raster.point(p);
  return points;
}

std::vector<double> blurred(const std::vector<double>& values, double sigma) {
  if (!(sigma > 0)) return values;
  const int n = static_cast<int>(values.size()), reach = static_cast<int>(std::ceil(4 * sigma));
  std::vector<double> result(values.size());
  for (int i = 0; i < n; ++i) {
    double sum = 0, weights = 0;
    for (int d = -reach; d <= reach; ++d) {
      const double weight = std::exp(-0.5 * d * d / (sigma * sigma));
      sum += weight * values[static_cast<std::size_t>(std::clamp(i + d, 0, n - 1))];
      weights += weight;
    }
    result[static_cast<std::size_t>(i)] = sum / weights;
  }
  return result;
}

/// c(t) = kappa L at even arc lengths.
std::vector<double> scaled_curvatures(const SplineCurve& curve, int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) {
    const double u = curve.parameter_at(curve.length() * k / (count - 1));
    values.push_back(curve.at(u).curvature() * curve.length());
  }
  return values;
}

/// A stretch of high values about their largest, above half of its height over the median.
struct Bump {
  int peak = 0;
  int first = 0, last = 0;
};

/// All bumps of at least the height, each named by its highest point.
std::vector<Bump> bumps(const std::vector<double>& values, double usual, double height) {
  std::vector<Bump> found;
  const int n = static_cast<int>(values.size());
  const auto above = [&](int i) { return values[static_cast<std::size_t>(i)] - usual; };
  for (int i = 1; i + 1 < n; ++i) {
    if (above(i) < height || above(i) < above(i - 1) || above(i) <= above(i + 1)) continue;
    Bump bump{i, i, i};
    while (bump.first > 0 && above(bump.first - 1) > 0.5 * above(i)) --bump.first;
    while (bump.last + 1 < n && above(bump.last + 1) > 0.5 * above(i)) ++bump.last;
    found.push_back(bump);
  }
  return found;
}

constexpr int kOutlinePoints = 2;  // for each of the contour's

}  // namespace

SkinContour smooth_contour(const Polyline& points, const SkinContourOptions& options) {
  const double length = polyline_length(points, false);
  constexpr std::size_t kFewestPoints = 24;
  if (points.size() < kFewestPoints) {
    throw InvalidInput(message(options.name, ": the skin contour has only ", points.size(),
                               " points, less than ", kFewestPoints, "; check the breast's mask."));
  }
  if (length < options.shortest_mm && !options.force) {
    throw InvalidInput(message(
        options.name, ": the skin contour is only ", std::lround(length), " mm long, less than ",
        options.shortest_mm, " mm; check the breast's mask, or go on all the same with --force."));
  }
  const FittedCurve fitted = fit_curve_within(points, options.smoothing_mm);
  SkinContour contour;
  contour.points = equal_arc_points(fitted.curve, options.num_points);
  contour.length_mm = fitted.curve.length();
  contour.rms_mm = fitted.rms_mm;
  contour.num_control_points = fitted.curve.num_control_points();
  contour.curvature = scaled_curvatures(fitted.curve, options.num_points);
  const double lowest = quantile(contour.curvature, 0.01);
  const double highest = quantile(contour.curvature, 0.99);
  for (double& c : contour.curvature) c = std::clamp(c, lowest, highest);
  contour.curvature = blurred(contour.curvature, options.curvature_blur);
  contour.nipple = find_nipple(points, options);
  contour.outline = equal_arc_points(fit_curve_within(points, options.outline_mm).curve,
                                     kOutlinePoints * options.num_points);
  contour.outline.front() = contour.points.front();
  contour.outline.back() = contour.points.back();
  return contour;
}

std::optional<Nipple> find_nipple(const Polyline& points, const SkinContourOptions& options) {
  const double length = polyline_length(points, false);
  const int num_control_points = std::min(static_cast<int>(length / options.nipple_knots_mm) + 3,
                                          static_cast<int>(points.size() / 4));
  if (num_control_points < 8) return std::nullopt;
  const SplineCurve curve = fit_curve(points, num_control_points).curve;
  const int count = std::max(64, static_cast<int>(2 * length));
  const double spacing = curve.length() / (count - 1);
  std::vector<double> outward =
      blurred(scaled_curvatures(curve, count), options.nipple_blur_mm / spacing);
  if (signed_area(points) < 0) {
    for (double& c : outward) c = -c;
  }
  const double usual = median(outward);
  std::vector<double> deviations;
  for (const double c : outward) deviations.push_back(std::abs(c - usual));
  const double sigma = 1.4826 * median(std::move(deviations));
  if (!(sigma > 0)) return std::nullopt;  // an even contour has no bump
  std::optional<Nipple> nipple;
  constexpr double kEnds = 0.05;  // of the length: there the film's edge bends the contour
  for (const Bump& bump : bumps(outward, usual, options.nipple_deviations * sigma)) {
    const double t = bump.peak / double(count - 1);
    const double width = (bump.last - bump.first + 1) * spacing;
    if (t < kEnds || t > 1 - kEnds) continue;
    if (width < options.nipple_narrowest_mm || width > options.nipple_widest_mm) continue;
    const double height = (outward[static_cast<std::size_t>(bump.peak)] - usual) / sigma;
    if (nipple && height <= nipple->deviations) continue;
    nipple = {curve.at(curve.parameter_at(t * curve.length())).point, t, height};
  }
  return nipple;
}

SkinContour find_skin_contour(const Mask<2>& mask, const SkinContourOptions& options) {
  const Raster<2>& raster = mask.raster();
  const int margin = std::max(
      1, static_cast<int>(std::lround(options.frame_margin_mm / raster.spacing.minCoeff())));
  const auto [width, height] = mask.size();
  const auto inside = [&, w = width, h = height](const cv::Point& p) {
    return p.x >= margin && p.y >= margin && p.x < w - margin && p.y < h - margin;
  };
  const std::vector<cv::Point> ring = border_pixels(mask);
  const Run run = longest_run(ring, inside);
  if (run.count == 0) {
    throw InvalidInput(message(options.name,
                               ": the breast has no border within the film; check its "
                               "mask."));
  }
  const bool outside_on_left = signed_area(as_points(ring)) < 0;
  Polyline skin = on_border(as_points(part(ring, run)), outside_on_left);
  Polyline rest =
      as_points(part(ring, {(run.first + run.count) % ring.size(), ring.size() - run.count}));
  if (skin.front().y() > skin.back().y()) {
    std::reverse(skin.begin(), skin.end());
    std::reverse(rest.begin(), rest.end());
  }
  SkinContour contour = smooth_contour(in_mm(skin, raster), options);
  contour.rest = simplify_polyline(in_mm(rest, raster), false, 0.5 * raster.spacing.minCoeff());
  return contour;
}

}  // namespace crease

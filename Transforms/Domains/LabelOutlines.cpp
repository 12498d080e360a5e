#include "Transforms/Domains/LabelOutlines.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "Core/Error.h"
#include "Transforms/Domains/Contours.h"
#include "Transforms/Domains/CurveSampling.h"
#include "Transforms/Domains/SmoothedLabels.h"

namespace crease {
namespace {

constexpr double kStep = 0.5;  // pixels between the points of a smoothed contour

void check_labels(const Raster<2>& raster, std::span<const std::int32_t> labels) {
  if (static_cast<std::int64_t>(labels.size()) != raster.num_samples()) {
    throw InvalidInput(message("label_outlines: ", labels.size(), " labels for an image of ",
                               raster.size[0], " x ", raster.size[1], " pixels."));
  }
  const auto lowest = std::min_element(labels.begin(), labels.end());
  if (lowest != labels.end() && *lowest < 0) {
    const auto pixel = lowest - labels.begin();
    throw InvalidInput(message("label_outlines: label ", *lowest, " at pixel (",
                               pixel % raster.size[0], ", ", pixel / raster.size[0],
                               ") is negative; use 0 for soft tissue and 1, 2, ... for bodies."));
  }
  if (std::all_of(labels.begin(), labels.end(), [](auto label) { return label == 0; })) {
    throw InvalidInput("label_outlines: the label image holds no body (all labels are 0).");
  }
}

/// A contour sampled in steps of kStep; open ones are continued by point reflection at their ends.
class Contour {
 public:
  Contour(Polyline points, bool closed) : points_(std::move(points)), closed_(closed) {}

  const Polyline& points() const { return points_; }
  int size() const { return static_cast<int>(points_.size()); }
  Point<2> at(int i) const {
    const int n = size();
    if (i >= 0 && i < n) return points_[i];
    if (closed_) return points_[((i % n) + n) % n];
    if (i < 0) return 2 * points_[0] - points_[std::min(-i, n - 1)];
    return 2 * points_[n - 1] - points_[std::max(2 * (n - 1) - i, 0)];
  }
  /// Gaussian means, sigma in pixels per point.
  Contour mean(const std::vector<double>& sigma) const;
  /// Smoothed without shrinking: twice the mean minus the mean of the mean. A circle of radius R moves by
  /// sigma^4 / (4 R^3) only.
  Contour smoothed(const std::vector<double>& sigma) const;
  /// The widest smoothing that moves no arc by more than kLargestBias, from `narrowest` upwards.
  std::vector<double> widest_smoothing(double narrowest, double widest) const;

 private:
  Polyline points_;
  bool closed_;
};

Contour Contour::mean(const std::vector<double>& sigma) const {
  Polyline result(points_.size());
  for (int i = 0; i < size(); ++i) {
    const double s = sigma[i] / kStep;
    const int radius = static_cast<int>(std::ceil(3.5 * s));
    Point<2> sum = points_[i];
    // exp(-k^2 / 2 s^2) by its ratios from k to k + 1.
    const double ratio_of_ratios = std::exp(-1 / (s * s));
    double weights = 1, w = 1, ratio = std::sqrt(ratio_of_ratios);
    for (int k = 1; k <= radius; ++k) {
      w *= ratio;
      ratio *= ratio_of_ratios;
      sum += w * (at(i - k) + at(i + k));
      weights += 2 * w;
    }
    result[i] = sum / weights;
  }
  return {std::move(result), closed_};
}

Contour Contour::smoothed(const std::vector<double>& sigma) const {
  Contour once = mean(sigma);
  const Contour twice = once.mean(sigma);
  for (int i = 0; i < size(); ++i) once.points_[i] = 2 * once.points_[i] - twice.points_[i];
  return once;
}

std::vector<double> Contour::widest_smoothing(double narrowest, double widest) const {
  constexpr double kLargestBias = 0.03;  // pixels
  constexpr double kGrowth = 0.25;       // of sigma per pixel along the contour
  const int reach = static_cast<int>(std::lround(2.5 * narrowest / kStep));
  std::vector<double> sigma(points_.size());
  for (int i = 0; i < size(); ++i) {
    const Vector<2> in = at(i) - at(i - reach), out = at(i + reach) - at(i);
    const double curvature = std::abs(turn_angle(in, out)) / (reach * kStep);
    const double bound = std::pow(4 * kLargestBias / std::pow(std::max(curvature, 1e-6), 3), 0.25);
    sigma[i] = std::clamp(bound, narrowest, widest);
  }
  const int rounds = closed_ ? 2 * size() : size();
  for (int i = 1; i < rounds; ++i) {
    const int here = i % size(), before = (i - 1) % size();
    sigma[here] = std::min(sigma[here], sigma[before] + kGrowth * kStep);
  }
  for (int i = rounds - 2; i >= 0; --i) {
    const int here = i % size(), after = (i + 1) % size();
    sigma[here] = std::min(sigma[here], sigma[after] + kGrowth * kStep);
  }
  return sigma;
}

/// Smooths the steps of the pixels away, more where the contour is straight, where steps are long.
Polyline smoothed_contour(const Polyline& contour, bool closed, double sigma) {
  constexpr double kWidest = 7;  // pixels
  const double length = polyline_length(contour, closed);
  const int count = std::max(closed ? 8 : 2, static_cast<int>(std::lround(length / kStep)));
  const Contour points(resample_polyline(contour, closed, count), closed);
  sigma = std::min(sigma, length / 12);  // short contours keep their shape
  if (sigma < 0.5 * kStep) return points.points();
  const Contour first = points.smoothed(std::vector<double>(points.points().size(), sigma));
  const double widest = std::max(sigma, std::min(kWidest, length / 12));
  return points.smoothed(first.widest_smoothing(sigma, widest)).points();
}

/// A point per pixel, or edges of the length wanted.
Polyline sampled(const Polyline& contour, bool closed, double pixel,
                 const LabelOutlineOptions& options) {
  if (!options.sampled) {
    const int count = static_cast<int>(std::lround(polyline_length(contour, closed) / pixel));
    return resample_polyline(contour, closed, std::max(closed ? 6 : 2, count));
  }
  const auto length = [&](const Point<2>&) { return options.edge_length; };
  const double tolerance = options.tolerance > 0 ? options.tolerance : 0.5 * pixel;
  return sample_curve(contour, closed, length, {.tolerance = tolerance, .keep_area = true}).points;
}

std::string name_of(const ContourArc& arc) {
  if (arc.right > 0) return message("border of bodies ", arc.right, " and ", arc.left);
  return message("body ", arc.left);
}

}  // namespace

LabelOutlines label_outlines(const Raster<2>& raster, std::span<const std::int32_t> labels,
                             const LabelOutlineOptions& options) {
  check_labels(raster, labels);
  const int width = raster.size[0], height = raster.size[1];
  const double pixel = raster.spacing.minCoeff();
  const double gap =
      options.smallest_gap >= 0 ? options.smallest_gap : std::max(0.0, 0.25 * options.edge_length);
  if (options.sampled && !(options.edge_length > 0)) {
    throw InvalidInput("label_outlines: sampled outlines need a positive edge_length.");
  }
  LabelOutlines result;

  std::vector<std::int32_t> closed_up(labels.begin(), labels.end());
  if (const int changed =
          close_narrow_gaps(width, height, closed_up, gap, raster.spacing[0], raster.spacing[1])) {
    result.warnings.push_back(message(changed, " soft pixels between bodies nearer than ", gap,
                                      " mm were given to the nearer body, so that they share a "
                                      "border there; use shorter edges to keep the gap."));
  }
  const SmoothedLabels smooth(width, height, closed_up, std::max(options.image_smoothing, 0.3));
  const auto arcs = trace_contours(smooth.width(), smooth.height(), smooth.labels(),
                                   [&](int label, int node) { return smooth.share(label, node); });

  const bool mirrored = raster.index_to_point().determinant() < 0;
  std::set<int> seen;
  for (const auto& arc : arcs) {
    if (arc.closed && std::abs(signed_area(arc.points)) < options.smallest_body) {
      const Point<2> p = raster.point(arc.points[0] - SmoothedLabels::kPad * Vector<2>::Ones());
      result.warnings.push_back(message("body ", arc.left, ": an island or hole of ",
                                        std::abs(signed_area(arc.points)), " pixels near (", p.x(),
                                        ", ", p.y(), ") mm is too small and left out."));
      seen.insert({arc.left, arc.right});
      continue;
    }
    seen.insert({arc.left, arc.right});
    FeatureLine line;
    Polyline contour = smoothed_contour(arc.points, arc.closed, options.contour_smoothing);
    for (auto& p : contour) p = raster.point(p - SmoothedLabels::kPad * Vector<2>::Ones());
    if (mirrored) std::reverse(contour.begin(), contour.end());
    line.points = sampled(contour, arc.closed, pixel, options);
    line.closed = arc.closed;
    line.left_label = arc.left;
    line.right_label = arc.right;
    line.body = arc.right == 0 ? BodySide::kLeft : BodySide::kNone;
    line.name = name_of(arc);
    result.lines.push_back(std::move(line));
  }
  for (int label : smooth.bodies()) {
    if (!seen.contains(label)) {
      result.warnings.push_back(message("body ", label, " is too small and left out."));
    }
  }
  return result;
}

}  // namespace crease

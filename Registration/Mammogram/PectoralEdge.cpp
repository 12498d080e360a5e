#include "Registration/Mammogram/PectoralEdge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "Core/Quantiles.h"
#include "Images/OpenCvView.h"

namespace crease::pectoral {
namespace {

constexpr double kRadian = std::numbers::pi / 180;

double squared_gradient(const View& view, int i, int j) {
  const double gx = view.gx(i, j), gy = view.gy(i, j);
  return gx * gx + gy * gy;
}

/// 70 % and 90 % quantiles of the gradient's size where edges may lie; none: nowhere.
std::optional<std::pair<double, double>> edge_thresholds(const View& view,
                                                         const cv::Rect& quadrant) {
  std::vector<double> sizes;
  for (int j = quadrant.y; j < quadrant.y + quadrant.height; ++j) {
    for (int i = quadrant.x; i < quadrant.x + quadrant.width; ++i) {
      if (view.allowed(i, j)) sizes.push_back(squared_gradient(view, i, j));
    }
  }
  if (sizes.size() < 100) return std::nullopt;
  const auto threshold = [&](double share) {
    return std::sqrt(value_of_rank(std::span(sizes), nearest_rank(std::ssize(sizes), share)));
  };
  return std::pair(threshold(0.7), threshold(0.9));
}

/// Canny's edges of the quadrant that are bright towards the corner, at a slope that a muscle may have.
cv::Mat edges_of(const View& view, const cv::Rect& quadrant, const PectoralOptions& options) {
  constexpr double kScale = 256, kTolerance = 15;  // fixed-point gradients; degrees
  const auto thresholds = edge_thresholds(view, quadrant);
  if (!thresholds) return {};
  cv::Mat gx, gy, edges;
  opencv_view(view.gx)(quadrant).convertTo(gx, CV_16S, kScale);
  opencv_view(view.gy)(quadrant).convertTo(gy, CV_16S, kScale);
  cv::Canny(gx, gy, edges, kScale * thresholds->first, kScale * thresholds->second, true);
  for (int j = 0; j < edges.rows; ++j) {
    for (int i = 0; i < edges.cols; ++i) {
      auto& edge = edges.at<std::uint8_t>(j, i);
      const double slope = std::atan2(-view.gy(i, j), -view.gx(i, j)) / kRadian;
      if (!view.allowed(i, j) || slope < options.smallest_slope_deg - kTolerance ||
          slope > options.largest_slope_deg + kTolerance) {
        edge = 0;
      }
    }
  }
  return edges;
}

}  // namespace

bool holds(const Mask<2>& mask, const Point<2>& p) {
  const auto [width, height] = mask.size();
  const int i = static_cast<int>(std::lround(p.x())), j = static_cast<int>(std::lround(p.y()));
  return i >= 0 && j >= 0 && i < width && j < height && mask(i, j) != 0;
}

double value_at(const Image<float, 2>& image, const Point<2>& p) {
  const auto [width, height] = image.size();
  const int i = static_cast<int>(std::floor(p.x())), j = static_cast<int>(std::floor(p.y()));
  if (i < 0 || j < 0 || i + 1 >= width || j + 1 >= height) return 0;
  const double x = p.x() - i, y = p.y() - j;
  const float* const upper = &image(i, j);
  const float* const lower = &image(i, j + 1);
  return (1 - y) * ((1 - x) * upper[0] + x * upper[1]) + y * ((1 - x) * lower[0] + x * lower[1]);
}

Vector<2> StraightLine::normal() const { return {std::cos(angle_rad), std::sin(angle_rad)}; }
Vector<2> StraightLine::direction() const { return {-std::sin(angle_rad), std::cos(angle_rad)}; }

std::optional<StraightLine> best_straight_line(const View& view, const PectoralOptions& options) {
  const auto [width, height] = view.grey.size();
  const cv::Rect quadrant(0, 0, width / 2, height / 2);
  const cv::Mat edges = edges_of(view, quadrant, options);
  if (edges.empty()) return std::nullopt;
  const int fewest = static_cast<int>(0.5 * options.shortest_mm / view.pixel_mm);
  std::vector<cv::Vec2f> lines;  // most votes first
  cv::HoughLines(edges, lines, 2, kRadian, fewest, 0, 0, options.smallest_slope_deg * kRadian,
                 options.largest_slope_deg * kRadian);
  if (lines.empty()) return std::nullopt;
  return StraightLine{lines[0][1], lines[0][0]};
}

Polyline cheapest_path(const View& view, const StraightLine& line, const PectoralOptions& options) {
  const int reach = std::max(1, static_cast<int>(std::lround(options.search_mm / view.pixel_mm)));
  const int width = 2 * reach + 1;
  const Vector<2> n = line.normal(), d = line.direction();
  const Point<2> upper = {line.offset / n.x(), 0.0}, lower = {0.0, line.offset / n.y()};
  const int steps = static_cast<int>((lower - upper).norm()) + 2 * reach;
  const auto point = [&](int step, int k) -> Point<2> {
    return upper + (step - reach) * d + (k - reach) * n;
  };
  // sums[step * width + k]: the least sum of a path from the first row to there, and its last column.
  std::vector<double> sums(static_cast<std::size_t>(steps) * width);
  std::vector<int> from(sums.size(), 0);
  for (int step = 0; step < steps; ++step) {
    for (int k = 0; k < width; ++k) {
      const Point<2> p = point(step, k);
      double gradient = 0;
      if (holds(view.allowed, p)) {
        gradient = std::max(0.0, -n.x() * value_at(view.gx, p) - n.y() * value_at(view.gy, p));
      }
      const double cost = 1 / (1 + gradient);
      const auto at = [&](int s, int column) {
        return static_cast<std::size_t>(s) * width + column;
      };
      if (step == 0) {
        sums[at(0, k)] = cost;
        continue;
      }
      double best = std::numeric_limits<double>::infinity();
      for (const int side : {0, -1, 1}) {  // straight on unless another way is cheaper
        if (k + side < 0 || k + side >= width) continue;
        const double length = side == 0 ? 1.0 : std::numbers::sqrt2;
        const double sum = sums[at(step - 1, k + side)] + cost * length;
        if (sum < best) {
          best = sum;
          from[at(step, k)] = k + side;
        }
      }
      sums[at(step, k)] = best;
    }
  }
  const auto last = sums.end() - width;
  int k = static_cast<int>(std::min_element(last, sums.end()) - last);
  Polyline path(static_cast<std::size_t>(steps));
  for (int step = steps - 1; step >= 0; --step) {
    path[static_cast<std::size_t>(step)] = point(step, k);
    k = from[static_cast<std::size_t>(step) * width + k];
  }
  return path;
}

}  // namespace crease::pectoral

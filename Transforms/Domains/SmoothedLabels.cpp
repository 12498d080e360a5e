#include "Transforms/Domains/SmoothedLabels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace crease {
namespace {

std::vector<float> gaussian_kernel(double sigma) {
  const int radius = std::max(1, static_cast<int>(std::ceil(4 * sigma)));
  std::vector<double> weights;
  double sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    weights.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += weights.back();
  }
  std::vector<float> kernel;
  for (double w : weights) kernel.push_back(static_cast<float>(w / sum));
  return kernel;
}

struct Extent {
  int left = std::numeric_limits<int>::max(), right = -1;
  int bottom = std::numeric_limits<int>::max(), top = -1;
  double num_pixels = 0;
};

std::map<int, Extent> label_extents(int width, int height, std::span<const std::int32_t> labels) {
  std::map<int, Extent> extents;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width;) {
      const int label = labels[static_cast<std::size_t>(j) * width + i];
      int end = i + 1;
      while (end < width && labels[static_cast<std::size_t>(j) * width + end] == label) ++end;
      if (label > 0) {
        Extent& extent = extents[label];
        extent.left = std::min(extent.left, i);
        extent.right = std::max(extent.right, end - 1);
        extent.bottom = std::min(extent.bottom, j);
        extent.top = std::max(extent.top, j);
        extent.num_pixels += end - i;
      }
      i = end;
    }
  }
  return extents;
}

}  // namespace

SmoothedLabels::SmoothedLabels(int width, int height, std::span<const std::int32_t> labels,
                               double sigma)
    : width_(width), height_(height) {
  const auto kernel = gaussian_kernel(sigma);
  const int margin = static_cast<int>(kernel.size()) / 2 + 1;
  background_.assign(static_cast<std::size_t>(this->width()) * this->height(), 1.0F);
  for (const auto& [label, extent] : label_extents(width, height, labels)) {
    // Bodies at the image's border go on to the rim.
    const int left = extent.left == 0 ? 0 : extent.left + kPad - margin;
    const int right = extent.right == width - 1 ? this->width() : extent.right + kPad + margin + 1;
    const int bottom = extent.bottom == 0 ? 0 : extent.bottom + kPad - margin;
    const int top = extent.top == height - 1 ? this->height() : extent.top + kPad + margin + 1;
    Window window;
    window.left = std::max(0, left);
    window.bottom = std::max(0, bottom);
    window.width = std::min(this->width(), right) - window.left;
    window.height = std::min(this->height(), top) - window.bottom;
    window = smoothed(labels, label, window, kernel);
    for (int j = 0; j < window.height; ++j) {
      float* row =
          &background_[static_cast<std::size_t>(j + window.bottom) * this->width() + window.left];
      for (int i = 0; i < window.width; ++i) row[i] -= window.values[j * window.width + i];
    }
    // Against the background alone, g + shift = 1 - g at the level wanted.
    window.shift = 1 - 2 * area_keeping_level(window, extent.num_pixels);
    windows_.emplace(label, std::move(window));
  }
  best_.assign(background_.size(), 0);
  std::vector<float> largest = background_;
  for (const auto& [label, window] : windows_) {
    for (int j = 0; j < window.height; ++j) {
      for (int i = 0; i < window.width; ++i) {
        const std::size_t node =
            static_cast<std::size_t>(j + window.bottom) * this->width() + window.left + i;
        const float value = window.values[static_cast<std::size_t>(j) * window.width + i];
        const auto share = static_cast<float>(value + window.shift);
        if (value > 0 && share > largest[node]) {
          largest[node] = share;
          best_[node] = label;
        }
      }
    }
  }
  clear_rim();
}

void SmoothedLabels::clear_rim() {
  for (int j = 0; j < height(); ++j) {
    const bool whole_row = j == 0 || j == height() - 1;
    for (int i = 0; i < width(); i += whole_row ? 1 : width() - 1) {
      best_[static_cast<std::size_t>(j) * width() + i] = 0;
    }
  }
}

double SmoothedLabels::share(int label, int node) const {
  if (label == 0) return background_[node];
  const Window& window = windows_.at(label);
  return window.at(node % width(), node / width()) + window.shift;
}

std::vector<int> SmoothedLabels::bodies() const {
  std::vector<int> result;
  for (const auto& [label, window] : windows_) result.push_back(label);
  return result;
}

SmoothedLabels::Window SmoothedLabels::smoothed(std::span<const std::int32_t> labels, int label,
                                                const Window& extent,
                                                const std::vector<float>& kernel) const {
  const int radius = static_cast<int>(kernel.size()) / 2;
  Window window = extent;
  window.values.assign(static_cast<std::size_t>(window.width) * window.height, 0.0F);
  const int rows = window.height + 2 * radius;
  std::vector<float> along_rows(static_cast<std::size_t>(window.width) * rows, 0.0F);
  std::vector<float> line(window.width + 2 * radius);
  for (int r = 0; r < rows; ++r) {
    const int y = std::clamp(window.bottom + r - radius - kPad, 0, height_ - 1);
    const std::int32_t* row = labels.data() + static_cast<std::size_t>(y) * width_;
    bool any = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const int x = std::clamp(window.left + static_cast<int>(i) - radius - kPad, 0, width_ - 1);
      line[i] = row[x] == label ? 1.0F : 0.0F;
      any = any || row[x] == label;
    }
    if (!any) continue;
    float* out = &along_rows[static_cast<std::size_t>(r) * window.width];
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      for (int i = 0; i < window.width; ++i) out[i] += kernel[k] * line[i + k];
    }
  }
  for (int j = 0; j < window.height; ++j) {
    float* out = &window.values[static_cast<std::size_t>(j) * window.width];
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const float* in = &along_rows[(j + k) * window.width];
      for (int i = 0; i < window.width; ++i) out[i] += kernel[k] * in[i];
    }
  }
  return window;
}

/// The level whose contour encloses the body's own area, by bisection; pixels at the contour count by
/// the part of them inside, (g - level) / |grad g| + 1/2.
double SmoothedLabels::area_keeping_level(const Window& window, double num_pixels) const {
  struct Pixel {
    double value, slope;
  };
  std::vector<Pixel> border;
  double sure = 0;
  // Nodes outside the image continue the body, but are none of its pixels.
  const int right = std::min(window.left + window.width, width_ + kPad);
  const int top = std::min(window.bottom + window.height, height_ + kPad);
  for (int y = std::max(kPad, window.bottom); y < top; ++y) {
    for (int x = std::max(kPad, window.left); x < right; ++x) {
      const double value = window.at(x, y);
      if (value > 0.98) {
        sure += 1;
      } else if (value > 0.02) {
        const double gx = window.at(x + 1, y) - window.at(x - 1, y);
        const double gy = window.at(x, y + 1) - window.at(x, y - 1);
        border.push_back({value, std::max(0.5 * std::hypot(gx, gy), 1e-3)});
      }
    }
  }
  double low = 0.3, high = 0.7;
  for (int step = 0; step < 20; ++step) {
    const double level = 0.5 * (low + high);
    double area = sure;
    for (const auto& pixel : border) {
      area += std::clamp((pixel.value - level) / pixel.slope + 0.5, 0.0, 1.0);
    }
    (area < num_pixels ? high : low) = level;
  }
  return 0.5 * (low + high);
}

int close_narrow_gaps(int width, int height, std::vector<std::int32_t>& labels, double gap_mm,
                      double dx, double dy) {
  const int rx = static_cast<int>(gap_mm / dx), ry = static_cast<int>(gap_mm / dy);
  if (rx < 1 && ry < 1) return 0;
  struct Step {
    double distance;
    int i, j;
  };
  std::vector<Step> steps;
  for (int j = -ry; j <= ry; ++j) {
    for (int i = -rx; i <= rx; ++i) {
      const double d = std::hypot(i * dx, j * dy);
      if (d <= gap_mm && d > 0) steps.push_back({d, i, j});
    }
  }
  std::stable_sort(steps.begin(), steps.end(),
                   [](const Step& a, const Step& b) { return a.distance < b.distance; });
  std::vector<char> near(labels.size(), 0);  // soft pixels within reach of a body
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const std::size_t p = static_cast<std::size_t>(j) * width + i;
      const bool rim =
          labels[p] > 0 &&
          ((i > 0 && labels[p - 1] == 0) || (i + 1 < width && labels[p + 1] == 0) ||
           (j > 0 && labels[p - width] == 0) || (j + 1 < height && labels[p + width] == 0));
      if (!rim) continue;
      for (int y = std::max(0, j - ry); y <= std::min(height - 1, j + ry); ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * width;
        for (int x = std::max(0, i - rx); x <= std::min(width - 1, i + rx); ++x) near[row + x] = 1;
      }
    }
  }
  const std::vector<std::int32_t> old = labels;
  int changed = 0;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const std::size_t p = static_cast<std::size_t>(j) * width + i;
      if (old[p] != 0 || !near[p]) continue;
      int nearest = 0;
      double distance = 0;
      for (const auto& step : steps) {
        const int x = i + step.i, y = j + step.j;
        if (x < 0 || y < 0 || x >= width || y >= height) continue;
        const int label = old[static_cast<std::size_t>(y) * width + x];
        if (label <= 0 || label == nearest) continue;
        if (nearest == 0) {
          nearest = label;
          distance = step.distance;
        } else if (distance + step.distance <= gap_mm + std::max(dx, dy)) {
          labels[p] = nearest;
          ++changed;
          break;
        } else {
          break;
        }
      }
    }
  }
  return changed;
}

}  // namespace crease

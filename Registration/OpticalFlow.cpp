#include "Registration/OpticalFlow.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

namespace crease {
namespace {

/// moving(A(x)) on the raster.
std::vector<float> seen_through(const Interpolator<2>& moving, const AffineMap<2>& affine,
                                const Raster<2>& raster) {
  std::vector<float> values(static_cast<std::size_t>(raster.num_samples()));
  std::vector<float> row_values(static_cast<std::size_t>(raster.size[0]) + 64), inside(row_values);
  for (int r = 0; r < raster.size[1]; ++r) {
    MappedRow<2> row;
    row.row = r;
    row.end = raster.size[0];
    row.start = affine(raster.row_start(r));
    row.step = affine.linear * raster.index_to_point().col(0);
    moving.evaluate_row(row, row_values.data() + 16, {nullptr, nullptr}, inside.data() + 16);
    std::copy_n(row_values.begin() + 16, raster.size[0],
                values.begin() + static_cast<std::ptrdiff_t>(r) * raster.size[0]);
  }
  return values;
}

cv::Mat eight_bit(const std::vector<float>& values, const Raster<2>& raster, float lowest,
                  float highest) {
  cv::Mat image(raster.size[1], raster.size[0], CV_8U);
  const float scale = highest > lowest ? 255.0f / (highest - lowest) : 0.0f;
  for (std::size_t i = 0; i < values.size(); ++i) {
    image.data[i] = static_cast<unsigned char>(
        std::lround(std::clamp((values[i] - lowest) * scale, 0.0f, 255.0f)));
  }
  return image;
}

cv::Mat dis_flow(const cv::Mat& from, const cv::Mat& to) {
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  cv::Mat flow;
  cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM)->calc(from, to, flow);
  cv::setNumThreads(threads);
  return flow;
}

/// |grad f|^2 per pixel^2 by central differences.
std::vector<float> squared_gradient(const std::vector<float>& f, int width, int height) {
  std::vector<float> g2(f.size(), 0.0f);
  for (int y = 1; y + 1 < height; ++y) {
    for (int x = 1; x + 1 < width; ++x) {
      const auto i = static_cast<std::size_t>(y) * width + x;
      const float gx = 0.5f * (f[i + 1] - f[i - 1]), gy = 0.5f * (f[i + width] - f[i - width]);
      g2[i] = gx * gx + gy * gy;
    }
  }
  return g2;
}

double masked_mean(const std::vector<float>& values, const std::vector<float>& mask) {
  double sum = 0, weight = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += static_cast<double>(mask[i]) * values[i];
    weight += mask[i];
  }
  return weight > 0 ? sum / weight : 0.0;
}

}  // namespace

FlowField optical_flow(const Image<float, 2>& fixed, const std::vector<float>& mask,
                       const Interpolator<2>& moving, const AffineMap<2>& affine) {
  const Raster<2>& raster = fixed.raster();
  const int width = raster.size[0], height = raster.size[1];
  const std::vector<float> seen = seen_through(moving, affine, raster);
  const auto [fixed_low, fixed_high] =
      std::minmax_element(fixed.values().begin(), fixed.values().end());
  const auto [seen_low, seen_high] = std::minmax_element(seen.begin(), seen.end());
  const float lowest = std::min(*fixed_low, *seen_low), highest = std::max(*fixed_high, *seen_high);
  const std::vector<float> values(fixed.values().begin(), fixed.values().end());
  const cv::Mat flow = dis_flow(eight_bit(values, raster, lowest, highest),
                                eight_bit(seen, raster, lowest, highest));

  FlowField field;
  field.raster = raster;
  for (auto& component : field.displacement) component.resize(values.size());
  std::vector<float> squared_residual(values.size());
  const Matrix<2> to_mm = raster.index_to_point();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(y) * width + x;
      const cv::Vec2f& f = flow.at<cv::Vec2f>(y, x);
      const Point<2> from = raster.point({x, y});
      const Point<2> target = affine(from + to_mm * Vector<2>(f[0], f[1]));
      const auto sample = moving.evaluate(target);
      const float r = static_cast<float>(sample.value) - values[i];
      squared_residual[i] = sample.inside ? r * r : HUGE_VALF;
      for (int a = 0; a < 2; ++a) {
        field.displacement[a][i] = static_cast<float>(target[a] - from[a]);
      }
    }
  }
  const std::vector<float> g2 = squared_gradient(values, width, height);
  const double mean_g2 = masked_mean(g2, mask);
  std::vector<float> finite_residual = squared_residual;
  for (float& r2 : finite_residual) {
    if (!std::isfinite(r2)) r2 = 0;
  }
  const double s2 = masked_mean(finite_residual, mask);
  field.weights.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double structure = g2[i] / (g2[i] + 0.2 * mean_g2 + 1e-30);
    const double trust = (s2 + 1e-30) / (s2 + 1e-30 + squared_residual[i]);
    field.weights[i] = static_cast<float>(mask[i] * structure * trust);
  }
  return field;
}

}  // namespace crease

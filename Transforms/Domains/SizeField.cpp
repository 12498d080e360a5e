#include "Transforms/Domains/SizeField.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Transforms/Domains/Polygon.h"

namespace crease {
namespace {

constexpr int kMostNodes = 128;  // along the longer side

}  // namespace

SizeField::SizeField(const Box<2>& box, const std::function<double(const Point<2>&)>& base,
                     std::vector<Segment> segments, double gradation)
    : segments_(std::move(segments)), gradation_(gradation), lower_(box.lower) {
  const double longest = box.size().maxCoeff();
  double finest = 0.25 * longest;
  for (const auto& segment : segments_) finest = std::min(finest, segment.length);
  finest = std::min(finest, base(0.5 * (box.lower + box.upper)));
  step_ = std::max(finest, longest / kMostNodes);
  width_ = static_cast<int>(std::ceil(box.size().x() / step_)) + 1;
  height_ = static_cast<int>(std::ceil(box.size().y() / step_)) + 1;
  values_.resize(static_cast<std::size_t>(width_) * height_);
  spread();
  for (int j = 0; j < height_; ++j) {
    for (int i = 0; i < width_; ++i) {
      double& value = values_[static_cast<std::size_t>(j) * width_ + i];
      value = std::min(value, base(node(i, j)));
    }
  }
}

double SizeField::claim(int segment, const Point<2>& p) const {
  const Segment& s = segments_[segment];
  return s.length + gradation_ * (p - closest_point_on_segment(p, s.a, s.b)).norm();
}

/// Every node learns the strongest claim from its neighbours, in sweeps over the four diagonal directions.
void SizeField::spread() {
  std::fill(values_.begin(), values_.end(), std::numeric_limits<double>::infinity());
  std::vector<int> owner(values_.size(), -1);
  const auto offer = [&](int segment, int i, int j) {
    const std::size_t n = static_cast<std::size_t>(j) * width_ + i;
    if (segment < 0 || segment == owner[n]) return;
    const double value = claim(segment, node(i, j));
    if (value < values_[n]) {
      values_[n] = value;
      owner[n] = segment;
    }
  };
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    const Vector<2> edge = segments_[s].b - segments_[s].a;
    const int count = 1 + static_cast<int>(edge.norm() / (0.5 * step_));
    for (int k = 0; k <= count; ++k) {
      const Vector<2> g = (segments_[s].a + static_cast<double>(k) / count * edge - lower_) / step_;
      const int i = static_cast<int>(std::floor(g.x())), j = static_cast<int>(std::floor(g.y()));
      for (int dj = 0; dj < 2; ++dj) {
        for (int di = 0; di < 2; ++di) {
          offer(static_cast<int>(s), std::clamp(i + di, 0, width_ - 1),
                std::clamp(j + dj, 0, height_ - 1));
        }
      }
    }
  }
  for (int round = 0; round < 2; ++round) {
    for (int sweep = 0; sweep < 4; ++sweep) {
      const int si = sweep % 2 == 0 ? 1 : -1, sj = sweep < 2 ? 1 : -1;
      for (int b = 0; b < height_; ++b) {
        const int j = sj > 0 ? b : height_ - 1 - b;
        for (int a = 0; a < width_; ++a) {
          const int i = si > 0 ? a : width_ - 1 - a;
          const int pi = i - si, pj = j - sj;
          const bool has_i = pi >= 0 && pi < width_, has_j = pj >= 0 && pj < height_;
          if (has_i) offer(owner[static_cast<std::size_t>(j) * width_ + pi], i, j);
          if (has_j) offer(owner[static_cast<std::size_t>(pj) * width_ + i], i, j);
          if (has_i && has_j) offer(owner[static_cast<std::size_t>(pj) * width_ + pi], i, j);
        }
      }
    }
  }
}

double SizeField::operator()(const Point<2>& p) const {
  const Vector<2> g = (p - lower_) / step_;
  const double x = std::clamp(g.x(), 0.0, width_ - 1.0), y = std::clamp(g.y(), 0.0, height_ - 1.0);
  const int i = std::min(static_cast<int>(x), std::max(0, width_ - 2));
  const int j = std::min(static_cast<int>(y), std::max(0, height_ - 2));
  const double s = x - i, t = y - j;
  const double* row = &values_[static_cast<std::size_t>(j) * width_ + i];
  const double* above = height_ > 1 ? row + width_ : row;
  const int right = width_ > 1 ? 1 : 0;
  return (1 - t) * ((1 - s) * row[0] + s * row[right]) +
         t * ((1 - s) * above[0] + s * above[right]);
}

}  // namespace crease

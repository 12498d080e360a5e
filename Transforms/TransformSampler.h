#pragma once

#include <span>
#include <vector>

#include "Transforms/Transform.h"

namespace crease {

/// A transform prepared for many points of which neighbours in the list lie near each other, as in a row of
/// a raster. Thread-safe; the transform must outlive it and stay as it is.
template <int InDim, int OutDim = InDim>
class TransformSampler {
 public:
  using Sample = typename Transform<InDim, OutDim>::Sample;
  virtual ~TransformSampler() = default;
  /// samples[k] = transform.sample(x[k]), but for rounding.
  virtual void sample(std::span<const Point<InDim>> x, std::span<Sample> samples) const = 0;
  /// y[k] = transform.map(x[k]), but for rounding.
  virtual void map(std::span<const Point<InDim>> x, std::span<Point<OutDim>> y) const {
    std::vector<Sample> samples(x.size());
    sample(x, samples);
    for (std::size_t k = 0; k < x.size(); ++k) y[k] = samples[k].point;
  }
};

/// One point after the other: what transforms do that have no faster way.
template <int InDim, int OutDim = InDim>
class OneByOneSampler final : public TransformSampler<InDim, OutDim> {
 public:
  using typename TransformSampler<InDim, OutDim>::Sample;
  explicit OneByOneSampler(const Transform<InDim, OutDim>& transform) : transform_(transform) {}
  void sample(std::span<const Point<InDim>> x, std::span<Sample> samples) const override {
    for (std::size_t k = 0; k < x.size(); ++k) samples[k] = transform_.sample(x[k]);
  }
  void map(std::span<const Point<InDim>> x, std::span<Point<OutDim>> y) const override {
    for (std::size_t k = 0; k < x.size(); ++k) y[k] = transform_.map(x[k]);
  }

 private:
  const Transform<InDim, OutDim>& transform_;
};

}  // namespace crease

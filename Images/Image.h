#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "Core/Error.h"
#include "Core/Raster.h"

namespace crease {

/// Pixels on a raster. The raster says where they lie (mm); pixel (i, j[, k]) is entry
/// i + size[0] * (j + size[1] * k) of values().
template <typename Pixel, int Dim>
class Image {
 public:
  using Index = std::array<int, Dim>;

  Image() = default;
  explicit Image(const Raster<Dim>& raster) : Image(raster, zero()) {}
  Image(const Raster<Dim>& raster, const Pixel& value)
      : raster_(raster), values_(static_cast<std::size_t>(raster.num_samples()), value) {}
  /// Pixels that exist already, such as those of an image on another raster of as many samples:
  /// `Image(raster, other.values())` copies them, `Image(raster, std::move(other).take_values())` does
  /// not.
  /// @throws InvalidInput when there are not as many values as samples.
  Image(const Raster<Dim>& raster, std::vector<Pixel> values)
      : raster_(raster), values_(std::move(values)) {
    if (std::ssize(values_) != raster.num_samples()) {
      throw InvalidInput(message("Image: ", values_.size(), " values for a raster of ",
                                 raster.num_samples(), " samples"));
    }
  }

  const Raster<Dim>& raster() const { return raster_; }
  const std::array<int, Dim>& size() const { return raster_.size; }
  bool empty() const { return values_.empty(); }

  const std::vector<Pixel>& values() const { return values_; }
  /// For changing pixels; their number stays.
  std::vector<Pixel>& values() { return values_; }
  std::vector<Pixel> take_values() && { return std::move(values_); }

  /// The `size[0]` pixels of row r, r = j (2D) or j + size[1] * k (3D).
  std::span<const Pixel> row(std::int64_t r) const {
    return {values_.data() + r * raster_.size[0], static_cast<std::size_t>(raster_.size[0])};
  }
  std::span<Pixel> row(std::int64_t r) {
    return {values_.data() + r * raster_.size[0], static_cast<std::size_t>(raster_.size[0])};
  }

  const Pixel& operator()(int i, int j) const requires(Dim == 2) { return values_[offset({i, j})]; }
  Pixel& operator()(int i, int j) requires(Dim == 2) { return values_[offset({i, j})]; }
  const Pixel& operator()(int i, int j, int k) const requires(Dim == 3) {
    return values_[offset({i, j, k})];
  }
  Pixel& operator()(int i, int j, int k) requires(Dim == 3) { return values_[offset({i, j, k})]; }
  const Pixel& operator[](const Index& index) const { return values_[offset(index)]; }
  Pixel& operator[](const Index& index) { return values_[offset(index)]; }

  /// Position of a pixel in values().
  std::size_t offset(const Index& index) const {
    std::int64_t n = index[Dim - 1];
    for (int a = Dim - 2; a >= 0; --a) n = n * raster_.size[a] + index[a];
    return static_cast<std::size_t>(n);
  }
  /// Pixel at a position in values().
  Index index(std::int64_t position) const {
    Index result{};
    for (int a = 0; a < Dim; ++a) {
      result[a] = static_cast<int>(position % raster_.size[a]);
      position /= raster_.size[a];
    }
    return result;
  }

 private:
  static Pixel zero() {
    if constexpr (requires { Pixel::Zero(); }) {
      return Pixel::Zero();
    } else {
      return Pixel();
    }
  }

  Raster<Dim> raster_;
  std::vector<Pixel> values_;
};

/// 1: the pixel counts, 0: it does not.
template <int Dim>
using Mask = Image<std::uint8_t, Dim>;

/// 0: background, k > 0: object k.
template <int Dim>
using LabelImage = Image<std::int32_t, Dim>;

/// T(x) - x at every sample x, in mm.
template <int Dim>
using DisplacementField = Image<Vector<Dim>, Dim>;

}  // namespace crease

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "Images/ImageFormat.h"

namespace crease {

/// An image as it stands in a file, before it becomes an Image: any dimension, any pixels. (No Eigen here:
/// ITK brings an older one of its own, and one source file cannot hold both.)
struct RawImage {
  std::vector<int> size;
  std::vector<double> spacing, origin;  // mm, one entry per axis
  std::vector<double> direction;        // unit vectors along the axes, one after the other
  bool spacing_known = false;           // the file tells it; otherwise it is 1 mm
  PixelType type = PixelType::kUint8;
  int num_components = 1;
  bool colour = false;                // the components are red, green, blue
  std::unique_ptr<std::byte[]> data;  // components of a pixel side by side; null: only the header
  std::vector<std::string> notes;

  std::int64_t num_pixels() const {
    std::int64_t n = 1;
    for (int s : size) n *= s;
    return n;
  }
  std::int64_t num_values() const { return num_pixels() * num_components; }
  std::int64_t num_bytes() const { return num_values() * bytes_per_value(type); }
  void allocate() {
    data = std::make_unique_for_overwrite<std::byte[]>(static_cast<std::size_t>(num_bytes()));
  }
  template <typename T>
  const T* values() const {
    return reinterpret_cast<const T*>(data.get());
  }
  template <typename T>
  T* values() {
    return reinterpret_cast<T*>(data.get());
  }
  /// Unit spacing at the origin along `dimension` axes.
  void set_plain_geometry(std::size_t dimension) {
    spacing.assign(dimension, 1.0);
    origin.assign(dimension, 0.0);
    direction.assign(dimension * dimension, 0.0);
    for (std::size_t a = 0; a < dimension; ++a) direction[a * dimension + a] = 1.0;
  }
};

}  // namespace crease

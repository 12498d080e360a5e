#pragma once

#include <array>
#include <memory>

#include "Images/IntensityRange.h"

namespace crease {

/// The pixels of an image with kPadding further ones on every side, mirrored at the centres of the
/// outer pixels (index -1 holds pixel 1), so that interpolation kernels meet no border.
template <int Dim>
class PaddedPixels {
 public:
  static constexpr int kPadding = 4;

  /// Pixels not yet set. @throws InvalidInput when the padded image would hold 2^31 pixels or more.
  explicit PaddedPixels(const std::array<int, Dim>& size);
  /// Copies the image and pads it. @throws InvalidInput as above, and as check_interpolable.
  explicit PaddedPixels(const Image<float, Dim>& image);

  /// Fills the padding from the pixels.
  void pad();

  const std::array<int, Dim>& size() const { return size_; }
  /// Floats from a pixel to its neighbour along each axis; stride()[0] == 1.
  const std::array<int, Dim>& stride() const { return stride_; }
  /// Pixel (0, 0[, 0]).
  const float* data() const { return values_.get() + first_; }
  float* data() { return values_.get() + first_; }
  /// Floats from pixel (0, 0[, 0]) to the first pixel of row r.
  std::int64_t row_offset(std::int64_t r) const {
    if constexpr (Dim == 2) return r * stride_[1];
    return (r % size_[1]) * stride_[1] + (r / size_[1]) * std::int64_t{stride_[Dim - 1]};
  }
  std::int64_t num_rows() const;

  /// The range of the pixels that are at most `reach` pixels (along every axis) from a pixel of the
  /// mask; null: of all pixels. @throws InvalidInput when the mask has another size or is empty.
  IntensityRange range(const Mask<Dim>* mask, int reach) const;

 private:
  std::array<int, Dim> size_{};
  std::array<int, Dim> stride_{};
  std::int64_t first_ = 0;
  std::unique_ptr<float[]> values_;
};

/// @throws InvalidInput when the raster is no raster or pixels are not finite or beyond 1e30 in
/// magnitude (values that mark missing data); says how many and where the first one is.
template <int Dim>
void check_interpolable(const Image<float, Dim>& image);

extern template class PaddedPixels<2>;
extern template class PaddedPixels<3>;
extern template void check_interpolable<2>(const Image<float, 2>&);
extern template void check_interpolable<3>(const Image<float, 3>&);

}  // namespace crease

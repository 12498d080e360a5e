#pragma once

// The one header of crease that names OpenCV. Include it where you want OpenCV's filters on crease's
// images, and link opencv_core yourself.

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <type_traits>

#include "Images/Image.h"

namespace crease {

namespace opencv_view_detail {

template <typename Pixel>
constexpr int mat_type() {
  if constexpr (std::is_same_v<Pixel, std::uint8_t>) return CV_8UC1;
  if constexpr (std::is_same_v<Pixel, std::uint16_t>) return CV_16UC1;
  if constexpr (std::is_same_v<Pixel, std::int16_t>) return CV_16SC1;
  if constexpr (std::is_same_v<Pixel, std::int32_t>) return CV_32SC1;
  if constexpr (std::is_same_v<Pixel, float>) return CV_32FC1;
  if constexpr (std::is_same_v<Pixel, double>) return CV_64FC1;
  if constexpr (std::is_same_v<Pixel, Vector<2>>) return CV_64FC2;
  return -1;
}

}  // namespace opencv_view_detail

/// The image's own pixels as a cv::Mat of size[1] rows and size[0] columns: nothing is copied, what
/// OpenCV writes is in the image. The image must outlive the matrix and not be moved or assigned to.
template <typename Pixel>
cv::Mat opencv_view(Image<Pixel, 2>& image) {
  constexpr int kType = opencv_view_detail::mat_type<Pixel>();
  static_assert(kType >= 0, "OpenCV has no such pixel type");
  return cv::Mat(image.size()[1], image.size()[0], kType, image.values().data());
}

/// The same for reading only.
template <typename Pixel>
const cv::Mat opencv_view(const Image<Pixel, 2>& image) {
  return opencv_view(const_cast<Image<Pixel, 2>&>(image));
}

/// A temporary's pixels would be gone before the matrix is used.
template <typename Pixel>
cv::Mat opencv_view(Image<Pixel, 2>&&) = delete;

}  // namespace crease

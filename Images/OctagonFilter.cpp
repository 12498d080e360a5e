#include "Images/OctagonFilter.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "Core/Error.h"
#include "Images/OpenCvView.h"

namespace crease {
namespace {

using Morphology = void (*)(cv::InputArray, cv::OutputArray, cv::InputArray, cv::Point, int, int,
                            const cv::Scalar&);

/// An octagon as the sum of a square of side 2 a + 1 and a diamond of radius d: a + d = r,
/// 2 a + d = round(1.4 r).
void apply(Morphology filter, cv::Mat& mask, int radius) {
  const int square = static_cast<int>(std::lround(1.4 * radius)) - radius;
  const int diamond = radius - square;
  const cv::Scalar border = cv::morphologyDefaultBorderValue();
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, {3, 3});
  const cv::Mat box = cv::getStructuringElement(cv::MORPH_RECT, {2 * square + 1, 2 * square + 1});
  cv::Mat result;
  filter(mask, result, box, {-1, -1}, 1, cv::BORDER_REPLICATE, border);
  filter(result, mask, cross, {-1, -1}, diamond, cv::BORDER_REPLICATE, border);
}

Mask<2> filtered(const Mask<2>& mask, int radius, Outside outside, Morphology first,
                 Morphology second) {
  if (radius < 1) throw InvalidInput("octagon filter: the radius must be at least a pixel.");
  const int pad = 2 * radius + 1;
  cv::Mat wide;
  cv::copyMakeBorder(opencv_view(mask), wide, pad, pad, pad, pad, cv::BORDER_CONSTANT,
                     outside == Outside::kForeground ? 1 : 0);
  apply(first, wide, radius);
  apply(second, wide, radius);
  Mask<2> result(mask.raster());
  cv::Mat out = opencv_view(result);
  wide(cv::Rect(pad, pad, mask.size()[0], mask.size()[1])).copyTo(out);
  return result;
}

}  // namespace

Mask<2> closed_by_octagon(const Mask<2>& mask, int radius, Outside outside) {
  return filtered(mask, radius, outside, cv::dilate, cv::erode);
}

Mask<2> opened_by_octagon(const Mask<2>& mask, int radius, Outside outside) {
  return filtered(mask, radius, outside, cv::erode, cv::dilate);
}

}  // namespace crease

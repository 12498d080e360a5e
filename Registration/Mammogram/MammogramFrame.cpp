#include "Registration/Mammogram/MammogramFrame.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "Core/Error.h"
#include "Core/Quantiles.h"
#include "Images/ImageFile.h"
#include "Images/IntensityRange.h"
#include "Images/OpenCvView.h"

namespace crease {
namespace {

/// Pixels first .. last - 1 along one axis.
struct Span {
  int first = 0, last = 0;
  int size() const { return last - first; }
};
using Frame = std::array<Span, 2>;

/// Whether dark stands for dense tissue: see find_frame. Every third pixel of every third row will do.
bool is_negative(const Image<float, 2>& image, const IntensityRange& range) {
  constexpr double kBand = 0.05, kClear = 0.02;
  const auto [width, height] = image.size();
  std::vector<float> border, centre;
  for (int j = 0; j < height; j += 3) {
    const double y = (j + 0.5) / height;
    for (int i = 0; i < width; i += 3) {
      const double x = (i + 0.5) / width;
      const double to_edge = std::min({x, 1 - x, y, 1 - y});
      if (to_edge < kBand) border.push_back(image(i, j));
      if (to_edge > 0.25) centre.push_back(image(i, j));
    }
  }
  const double edge = median(std::move(border));
  const double difference = edge - median(std::move(centre));
  if (std::abs(difference) > kClear * range.width()) return difference > 0;
  return edge > 0.5 * (range.lower + range.upper);
}

/// The box of rows and columns that show more than the padding.
Frame film_in(const Image<float, 2>& image, bool negative, const IntensityRange& range,
              double share) {
  const Frame whole = {Span{0, image.size()[0]}, Span{0, image.size()[1]}};
  const cv::Mat pixels = opencv_view(image);
  const cv::Mat shown = (negative ? pixels < range.upper : pixels > range.lower) & 1;
  std::array<cv::Mat, 2> counts;  // of each column, of each row
  for (int a = 0; a < 2; ++a) cv::reduce(shown, counts[a], a, cv::REDUCE_SUM, CV_32S);
  Frame film = whole;
  for (int a = 0; a < 2; ++a) {
    const double least = share * whole[1 - a].size();
    const auto shows = [&](int i) { return counts[a].at<int>(i) > least; };
    while (film[a].size() > 1 && !shows(film[a].first)) ++film[a].first;
    while (film[a].size() > 1 && !shows(film[a].last - 1)) --film[a].last;
  }
  return film;
}

/// An edge of the film: the pixels of its rows (axis 1) or columns (axis 0), counted from outside.
struct Edge {
  int axis = 0, outermost = 0, step = 1;
  const char* name = "";
};

/// The share of a row's or column's pixels that are clearly brighter than those of another one.
double share_brighter(const Image<float, 2>& image, const Span& across, int axis, int line,
                      int other, float clearly) {
  int count = 0;
  for (int k = across.first; k < across.last; ++k) {
    const float here = axis == 0 ? image(line, k) : image(k, line);
    const float there = axis == 0 ? image(other, k) : image(k, other);
    count += clearly > 0 ? here - there > clearly : here - there < clearly;
  }
  return count / double(across.size());
}

/// Rows or columns at an edge that are brighter than what lies behind them over a part of their length, while
/// there is no such step farther in.
int scanner_line_width(const Image<float, 2>& image, const Frame& film, const Edge& edge,
                       int widest, float clearly) {
  constexpr double kPart = 0.1;
  const auto steps = [&](int from, int to) {
    return share_brighter(image, film[1 - edge.axis], edge.axis, edge.outermost + from * edge.step,
                          edge.outermost + to * edge.step, clearly) > kPart;
  };
  for (int width = 1; width <= widest; ++width) {
    if (steps(0, width)) return steps(width, width + 1) ? 0 : width;
  }
  return 0;
}

/// Cuts bright lines along the film's edges off.
/// @param clearly  a difference of grey values; negative where dark stands for bright.
Frame without_scanner_lines(const Image<float, 2>& image, Frame film,
                            const std::array<int, 2>& widest, float clearly,
                            std::vector<std::string>& notes) {
  for (int a = 0; a < 2; ++a) {
    if (film[a].size() <= 4 * (widest[a] + 1)) continue;
    const Edge before{a, film[a].first, 1, a == 0 ? "left" : "upper"};
    const Edge after{a, film[a].last - 1, -1, a == 0 ? "right" : "lower"};
    for (const Edge& edge : {before, after}) {
      const int width = scanner_line_width(image, film, edge, widest[a], clearly);
      (edge.step > 0 ? film[a].first : film[a].last) += edge.step * width;
      if (width == 0) continue;
      notes.push_back(message("a bright line of ", width, width == 1 ? " pixel" : " pixels",
                              " along the film's ", edge.name, " edge was cut off"));
    }
  }
  return film;
}

Raster<2> mended(Raster<2> raster, const MammogramFrameOptions& options,
                 std::vector<std::string>& notes) {
  constexpr double kAssumed = 0.2;
  if (options.pixel_size_mm) {
    if (!(*options.pixel_size_mm > 0) || !std::isfinite(*options.pixel_size_mm)) {
      throw InvalidInput(message(options.name, ": a pixel of ", *options.pixel_size_mm,
                                 " mm cannot be; give a positive size."));
    }
    raster.spacing.setConstant(*options.pixel_size_mm);
  } else if (!options.spacing_known) {
    raster.spacing.setConstant(kAssumed);
    notes.push_back(message("the pixel size is not known: ", kAssumed, " mm is assumed"));
  }
  return raster;
}

/// The frame's pixels, resampled: bright tissue, grey values as in the image.
Image<float, 2> resampled(const Image<float, 2>& image, const MammogramFrame& frame,
                          const MammogramFrameOptions& options, std::vector<std::string>& notes) {
  Raster<2> raster = frame.raster;
  const Vector<2> extent(frame.size[0] * raster.spacing.x(), frame.size[1] * raster.spacing.y());
  double pixel = options.working_pixel_mm;
  if (extent.maxCoeff() > options.largest * pixel) {
    pixel = extent.maxCoeff() / options.largest;
    notes.push_back(
        message("the image is very large: it is processed with pixels of ", pixel, " mm"));
  }
  Vector<2> centre_of_first;
  for (int a = 0; a < 2; ++a) {
    raster.size[a] = std::max(1, static_cast<int>(std::lround(extent[a] / pixel)));
    const double step = double(frame.size[a]) / raster.size[a];  // in the image's pixels
    centre_of_first[a] = frame.first[a] + 0.5 * step - 0.5;
    raster.spacing[a] *= step;
  }
  raster.origin = frame.raster.point(centre_of_first);
  Image<float, 2> result(raster);
  cv::Mat out = opencv_view(result);
  const cv::Rect window(frame.first[0], frame.first[1], frame.size[0], frame.size[1]);
  const cv::Mat film = opencv_view(image)(window);
  const bool finer = raster.size[0] > frame.size[0] || raster.size[1] > frame.size[1];
  cv::resize(film, out, out.size(), 0, 0, finer ? cv::INTER_LINEAR : cv::INTER_AREA);
  if (frame.inverted) out.convertTo(out, -1, -1, frame.value_sum);
  return result;
}

void check(const Image<float, 2>& image, const MammogramFrameOptions& options) {
  check_finite(image, options.name);
  const auto [width, height] = image.size();
  if (std::min(width, height) < options.smallest) {
    throw InvalidInput(message(options.name, ": ", width, " x ", height,
                               " pixels are too few for a mammogram; at least ", options.smallest,
                               " along both axes are needed."));
  }
  if (!(options.working_pixel_mm > 0)) {
    throw InvalidInput("find_frame: the working pixel must be a positive number of mm.");
  }
}

void check_size(const std::array<int, 2>& size, const MammogramFrame& frame) {
  if (size == frame.raster.size) return;
  throw InvalidInput(message("mammogram: an image or mask of ", size[0], " x ", size[1],
                             " pixels does not belong to a frame that was found in one of ",
                             frame.raster.size[0], " x ", frame.raster.size[1], "."));
}

}  // namespace

AffineMap<2> MammogramFrame::reflection() const {
  const Vector<2> axis = raster.direction.col(0);
  const Point<2> middle = raster.point({first[0] + 0.5 * (size[0] - 1), 0.0});
  AffineMap<2> map;
  map.linear -= 2 * axis * axis.transpose();
  map.offset = 2 * axis.dot(middle) * axis;
  return map;
}

MammogramFrame find_frame(const Image<float, 2>& image, const MammogramFrameOptions& options) {
  constexpr double kClearly = 0.05;  // of the grey values
  check(image, options);
  const IntensityRange range = intensity_range(image);
  if (range.constant()) {
    throw InvalidInput(message(options.name, ": all pixels have the value ", range.lower,
                               "; this is no mammogram."));
  }
  MammogramFrame frame;
  frame.raster = mended(image.raster(), options, frame.notes);
  frame.inverted = is_negative(image, range);
  frame.value_sum = range.lower + range.upper;
  if (frame.inverted) frame.notes.emplace_back("the image is a negative and was inverted");
  Frame film = film_in(image, frame.inverted, range, options.padding_share);
  std::array<int, 2> widest;
  for (int a = 0; a < 2; ++a) {
    widest[a] = std::max(
        1, static_cast<int>(std::lround(options.scanner_line_mm / frame.raster.spacing[a])));
  }
  const double clearly = (frame.inverted ? -kClearly : kClearly) * range.width();
  film = without_scanner_lines(image, film, widest, static_cast<float>(clearly), frame.notes);
  for (int a = 0; a < 2; ++a) {
    frame.first[a] = film[a].first;
    frame.size[a] = film[a].size();
  }
  frame.image = resampled(image, frame, options, frame.notes);
  return frame;
}

MammogramFrame mirrored(const MammogramFrame& frame) {
  MammogramFrame result = frame;
  const AffineMap<2> reflection = frame.reflection();
  result.raster.origin = reflection(frame.raster.origin);
  result.raster.direction = reflection.linear * frame.raster.direction;
  cv::Mat out = opencv_view(result.image);
  cv::flip(opencv_view(frame.image), out, 1);
  return result;
}

Image<float, 2> upright_image(Image<float, 2> image, const MammogramFrame& frame) {
  check_size(image.size(), frame);
  if (frame.inverted) {
    const auto sum = static_cast<float>(frame.value_sum);
    for (float& v : image.values()) v = sum - v;
  }
  return {frame.raster, std::move(image).take_values()};
}

Mask<2> mask_in_frame(const Mask<2>& mask, const MammogramFrame& frame) {
  check_size(mask.size(), frame);
  const cv::Rect window(frame.first[0], frame.first[1], frame.size[0], frame.size[1]);
  const cv::Mat set = opencv_view(mask)(window) != 0;
  Mask<2> result(frame.image.raster());
  cv::Mat out = opencv_view(result), shares;
  cv::resize(set, shares, out.size(), 0, 0, cv::INTER_AREA);
  cv::Mat((shares > 127) & 1).copyTo(out);
  return result;
}

}  // namespace crease

#include "Registration/Mammogram/BreastSegmentation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "Core/Parallel.h"
#include "Images/OctagonFilter.h"
#include "Images/OpenCvView.h"

namespace crease {
namespace {

int in_pixels(double mm, const Raster<2>& raster) {
  return std::max(1, static_cast<int>(std::lround(mm / raster.spacing.minCoeff())));
}

[[noreturn]] void fail(const BreastSegmentationOptions& options, const GreyHistogram& histogram,
                       const std::string& reason) {
  throw NoBreastFound(message("no breast found in ", options.name, ": ", reason,
                              "; give the grey value of its edge (--threshold), or an outline "
                              "and pairs of points (--roi FILE, --pairs FILE)."),
                      histogram);
}

Mask<2> above(const Image<float, 2>& image, double threshold) {
  Mask<2> mask(image.raster());
  parallel_for(image.size()[1], [&](std::int64_t r) {
    const auto from = image.row(r);
    const auto to = mask.row(r);
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i] > threshold ? 1 : 0;
  });
  return mask;
}

/// Foreground pixels in the outermost columns of a side: a share of the width, at least one column.
std::int64_t pixels_in_band(const Mask<2>& mask, ChestSide side, double share) {
  const int width = mask.size()[0];
  const int band = std::clamp(static_cast<int>(std::lround(share * width)), 1, width);
  const int first = side == ChestSide::kLeft ? 0 : width - band;
  const cv::Mat view = opencv_view(mask);
  return cv::countNonZero(view(cv::Rect(first, 0, band, mask.size()[1])));
}

ChestSide chest_side(const Mask<2>& mask, double share) {
  return pixels_in_band(mask, ChestSide::kLeft, share) >=
                 pixels_in_band(mask, ChestSide::kRight, share)
             ? ChestSide::kLeft
             : ChestSide::kRight;
}

/// The largest 4-connected component that has pixels in the outermost column of the side; empty: none.
Mask<2> component_at(const Mask<2>& mask, ChestSide side) {
  cv::Mat labels, statistics, centroids;
  const int count =
      cv::connectedComponentsWithStats(opencv_view(mask), labels, statistics, centroids, 4, CV_32S);
  const int left = side == ChestSide::kLeft ? 0 : mask.size()[0] - 1;
  std::vector<bool> touches(static_cast<std::size_t>(count), false);
  for (int j = 0; j < labels.rows; ++j) touches[labels.at<int>(j, left)] = true;
  int best = 0;
  for (int k = 1; k < count; ++k) {
    if (!touches[k]) continue;
    const auto area = [&](int label) { return statistics.at<int>(label, cv::CC_STAT_AREA); };
    if (best == 0 || area(k) > area(best)) best = k;
  }
  Mask<2> result(mask.raster());
  cv::Mat out = opencv_view(result);
  if (best > 0) cv::Mat((labels == best) & 1).copyTo(out);
  return result;
}

void fill_holes(Mask<2>& mask) {
  cv::Mat view = opencv_view(mask);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(view, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::drawContours(view, contours, -1, cv::Scalar(1), cv::FILLED);
}

double mean_over(const Image<float, 2>& image, const cv::Mat& mask) {
  return cv::mean(opencv_view(image), mask)[0];
}

/// The residue of an opening that is a label: fills its bounding box and is brighter than the breast.
/// Returns the labels' pixels, and notes their boxes.
cv::Mat labels_in(const Image<float, 2>& image, const Mask<2>& breast, int radius,
                  const BreastSegmentationOptions& options, std::vector<std::string>& warnings) {
  const Mask<2> opened = opened_by_octagon(breast, radius, Outside::kForeground);
  cv::Mat residue = opencv_view(breast) & ~(opencv_view(opened) * 255);
  // Slivers along the opened border would join with labels: a label is wider than they are.
  cv::Mat core;
  const int sliver = std::max(2, in_pixels(options.octagon_radius_mm, breast.raster()) / 2);
  cv::morphologyEx(residue, core, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_RECT, {2 * sliver + 1, 2 * sliver + 1}));
  cv::Mat components, statistics, centroids;
  const int count =
      cv::connectedComponentsWithStats(core, components, statistics, centroids, 4, CV_32S);
  const double breast_mean = mean_over(image, opencv_view(opened));
  cv::Mat labels = cv::Mat::zeros(core.size(), CV_8U);
  for (int k = 1; k < count; ++k) {
    const auto of = [&](int what) { return statistics.at<int>(k, what); };
    const int width = of(cv::CC_STAT_WIDTH), height = of(cv::CC_STAT_HEIGHT);
    if (of(cv::CC_STAT_AREA) < options.label_fill * width * height) continue;
    const cv::Mat pixels = components == k;
    if (mean_over(image, pixels) <= breast_mean) continue;
    labels.setTo(1, pixels);
    const Point<2> first =
        breast.raster().point({double(of(cv::CC_STAT_LEFT)), double(of(cv::CC_STAT_TOP))});
    const Point<2> last =
        first + breast.raster().index_to_point() * Vector<2>(width - 1, height - 1);
    const auto at = [](const Point<2>& p) {
      return message("(", std::lround(p.x()), ", ", std::lround(p.y()), ")");
    };
    warnings.push_back(message(options.name, ": a label that touches the breast was cut off, from ",
                               at(first), " to ", at(last), " mm"));
  }
  return labels;
}

/// Cuts bright rectangles off that hang on the breast, by openings of twice and four times the radius.
void cut_labels(const Image<float, 2>& image, int radius, const BreastSegmentationOptions& options,
                BreastSegmentation& breast) {
  for (const int factor : {2, 4}) {
    const cv::Mat labels = labels_in(image, breast.mask, factor * radius, options, breast.warnings);
    if (cv::countNonZero(labels) == 0) continue;
    cv::Mat view = opencv_view(breast.mask);
    view.setTo(0, labels);
    // What is left of the label's edges and of its bridge goes with the usual opening.
    breast.mask =
        component_at(opened_by_octagon(breast.mask, radius, Outside::kForeground), breast.side);
    fill_holes(breast.mask);
  }
}

/// Area, sides and edges of a finished mask.
void check(const BreastSegmentationOptions& options, BreastSegmentation& breast) {
  const auto [width, height] = breast.mask.size();
  const cv::Mat view = opencv_view(breast.mask);
  const int pixels = cv::countNonZero(view);
  const double share = pixels / (double(width) * height);
  const auto percent = [](double x) { return std::round(1000 * x) / 10; };
  if (pixels == 0) {
    fail(options, breast.histogram,
         "nothing bright touches the left or the right edge of the film");
  }
  if (share < options.smallest_area || share > options.largest_area) {
    fail(options, breast.histogram,
         message("what is bright takes up ", percent(share), " % of the film, not ",
                 percent(options.smallest_area), " to ", percent(options.largest_area), " %"));
  }
  if (pixels_in_band(breast.mask, opposite(breast.side), 0) > 0) {
    fail(options, breast.histogram, "what is bright touches both the left and the right edge");
  }
  breast.area_mm2 = pixels * breast.mask.raster().sample_volume();
  breast.cut_above = cv::countNonZero(view.row(0)) > 0;
  breast.cut_below = cv::countNonZero(view.row(height - 1)) > 0;
  for (const auto& [cut, edge] :
       {std::pair(breast.cut_above, "upper"), std::pair(breast.cut_below, "lower")}) {
    if (!cut) continue;
    breast.notes.push_back(
        message("the breast is cut by the film's ", edge, " edge; its contour ends there"));
  }
}

}  // namespace

std::string to_string(ChestSide side) { return side == ChestSide::kLeft ? "left" : "right"; }

BreastSegmentation segment_breast(const Image<float, 2>& image,
                                  const BreastSegmentationOptions& options) {
  BreastSegmentation breast;
  breast.histogram = grey_histogram(image);
  if (breast.histogram.upper <= breast.histogram.lower) {
    fail(options, breast.histogram, "all its pixels are equal");
  }
  breast.threshold =
      options.threshold.value_or(breast.histogram.grey_value(breast.histogram.threshold()));
  if (!options.threshold && !breast.histogram.valley) {
    breast.warnings.push_back(message(options.name,
                                      ": the histogram has no valley between film and "
                                      "breast; Otsu's threshold, grey value ",
                                      breast.threshold, ", is used"));
  }
  const int radius = in_pixels(options.octagon_radius_mm, image.raster());
  Mask<2> mask = above(image, breast.threshold);
  mask = closed_by_octagon(mask, radius, Outside::kBackground);
  mask = opened_by_octagon(mask, radius, Outside::kForeground);
  breast.side = chest_side(mask, options.chest_band);
  breast.mask = component_at(mask, breast.side);
  fill_holes(breast.mask);
  cut_labels(image, radius, options, breast);
  check(options, breast);
  return breast;
}

BreastSegmentation segmentation_of_mask(const Mask<2>& mask,
                                        const BreastSegmentationOptions& options) {
  BreastSegmentation breast;
  breast.mask = Mask<2>(mask.raster());
  std::transform(mask.values().begin(), mask.values().end(), breast.mask.values().begin(),
                 [](std::uint8_t v) { return v != 0 ? 1 : 0; });
  breast.side = chest_side(breast.mask, options.chest_band);
  breast.mask = component_at(breast.mask, breast.side);
  fill_holes(breast.mask);
  check(options, breast);
  return breast;
}

}  // namespace crease

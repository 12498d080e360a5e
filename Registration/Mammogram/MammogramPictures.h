#pragma once

#include <string>
#include <utility>
#include <vector>

#include "Registration/Landmarks.h"
#include "Registration/Mammogram/MammogramAnatomy.h"
#include "Registration/Pictures.h"

namespace crease {

/// One film for `overlay_contours`, which reads the anatomy's resampled image.
struct AnatomyPanel {
  std::string title;
  const MammogramAnatomy* anatomy = nullptr;  ///< must outlive the call
  std::vector<Point<2>> points = {};          ///< further points to mark, such as contour pairs, mm
};

/// Films side by side with the mask's outline, the skin line, the nipple and the pectoral line.
Picture overlay_contours(const std::vector<AnatomyPanel>& panels);

/// The smoothed histogram of the grey values with the background's peak, Otsu's threshold and the valley.
Picture histogram_picture(const GreyHistogram& histogram);

}  // namespace crease

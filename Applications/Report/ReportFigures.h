#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Core/Point.h"

namespace crease {

// What an HtmlReport shows: tables, curves, and stacks of pixels to look at in viewers. Texts are plain:
// the report escapes them.

/// Rows of texts under titled columns. Columns named in `numbers` are set flush right.
struct ReportTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<int> numbers = {};
  std::vector<std::vector<std::string>> rows = {};
  std::string note = {};
  bool varies = false;  ///< from run to run, times for example: marked in the page's source
};

/// Curves over iterations that run through several sections (levels), one after the other.
struct ReportPlot {
  struct Curve {
    std::string name;
    std::vector<std::optional<double>> values;  ///< per iteration; none: a gap
  };
  struct Section {
    std::string name;
    int count = 0;  ///< iterations
  };
  std::string title, x_label, y_label;
  std::vector<Section> sections;
  std::vector<Curve> curves;
};

/// The meaning of a layer's bytes: 0 is "no value"; `first` to 255 are values from `lower` to `upper` in
/// equal steps, in equal ratios if logarithmic, both ends standing for what lies beyond as well.
struct ReportScale {
  double lower = 0, upper = 1;
  bool logarithmic = false;
  int first = 1;                     ///< 2: byte 1 is `special`
  std::string special = {};          ///< such as "folded"
  std::string special_colour = {};   ///< "#39ff14"
  std::vector<std::string> colours;  ///< from lower to upper at equal distances, "#440154"
  std::vector<std::pair<double, std::string>> ticks = {};  ///< position 0 to 1, and text
  std::string label = {};                                  ///< of the colour bar

  std::uint8_t byte(double value) const;
};

/// Parallel slices of pixels, all of one size, and where they lie.
struct ReportPlane {
  struct Place {
    std::string label;              ///< "z = 12.5 mm"
    std::vector<double> origin_mm;  ///< of the first pixel's centre
  };
  std::string name;  ///< "axial"; "" where there is but one plane
  int width = 0, height = 0;
  double width_mm = 0, height_mm = 0;
  std::vector<double> right_mm, down_mm;  ///< from pixel to pixel
  std::vector<Place> slices;
};

/// One image in a stack: per plane a grey PNG that shows the slices one below the other.
struct ReportLayer {
  std::string name;
  ReportScale scale;
  std::vector<std::string> png;
};

/// Lines and points over the pixels, in pixels (centres at whole numbers) of each slice of each plane.
struct ReportOverlay {
  enum class Look { kGrid, kFeature, kLandmark, kPlace };
  struct Mark {
    Point<2> at = Point<2>::Zero();
    bool ring = true;  ///< else a cross
    std::string label = {};
  };
  struct Drawing {
    std::vector<std::vector<Point<2>>> lines;
    std::vector<Mark> marks;
  };
  std::string name;
  Look look = Look::kGrid;
  std::vector<std::vector<Drawing>> drawings;  ///< [plane][slice]
  Drawing& drawing(int plane, int slice) {
    return drawings[static_cast<std::size_t>(plane)][static_cast<std::size_t>(slice)];
  }
};

/// Layers on the same planes, and what may be drawn over them.
struct ReportStack {
  std::vector<ReportPlane> planes;
  std::vector<ReportLayer> layers;
  std::vector<ReportOverlay> overlays;
  std::string note;  ///< what was left out
};

/// A place worth a look, to jump to.
struct ReportPlace {
  std::string text;
  std::vector<int> slices;  ///< per plane: the one that shows it
};

/// A window on a stack.
struct ReportViewer {
  enum class Kind {
    kCompare,  ///< any two of the layers, the first two at first: swipe, flicker, blend, checkerboard
    kMaps      ///< layers side by side with colour bars
  };
  Kind kind = Kind::kMaps;
  int stack = 0;
  std::string title;
  std::vector<int> layers;              ///< of the stack
  std::vector<int> overlays = {};       ///< of the stack, drawn
  std::vector<int> more_overlays = {};  ///< offered
  bool contrast = false;                ///< colours may be stretched about their middle
  std::vector<ReportPlace> places = {};
  std::string note = {};
};

}  // namespace crease

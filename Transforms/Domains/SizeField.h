#pragma once

#include <functional>
#include <vector>

#include "Core/Box.h"
#include "Core/Point.h"

namespace crease {

/// Wanted edge length over a box: what the segments given ask for near them, growing with the distance up to a
/// length that depends on the place.
///
/// size(p) = min( base(p), min over segments (length of the segment + gradation * distance to it) ), sampled on a
/// grid and interpolated linearly. Distances are carried from node to node, with an error far below a
/// grid step.
class SizeField {
 public:
  struct Segment {
    Point<2> a, b;
    double length = 0;  ///< wanted on it, mm
  };

  SizeField(const Box<2>& box, const std::function<double(const Point<2>&)>& base,
            std::vector<Segment> segments, double gradation);

  /// Outside the box: as at its border.
  double operator()(const Point<2>& p) const;

 private:
  double claim(int segment, const Point<2>& p) const;
  void spread();
  Point<2> node(int i, int j) const { return lower_ + step_ * Vector<2>(i, j); }

  std::vector<Segment> segments_;
  double gradation_;
  Point<2> lower_;
  double step_ = 1;  // mm between nodes
  int width_ = 0, height_ = 0;
  std::vector<double> values_;
};

}  // namespace crease

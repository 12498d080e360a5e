#pragma once

#include <vector>

#include "Transforms/Domains/LineArrangement.h"

namespace crease {

/// Places on the border where lines end or touch it.
struct BorderMeetings {
  std::vector<Point<2>> points;
  int num_moved = 0;
  double largest_shift = 0;  ///< mm
};

/// Moves line ends within `near` mm of the border onto it; meetings within `near` of each other, or of a corner of
/// the border, become one. Points of lines on the border are meetings too.
BorderMeetings attach_to_border(const RegionOfInterest& region, std::vector<FeatureLine>& lines,
                                double near, double tolerance);

/// The rings of the region, divided into the lengths wanted, with a vertex at each meeting.
std::vector<Polyline> sampled_border(const RegionOfInterest& region,
                                     const std::vector<Point<2>>& meetings,
                                     const LineArrangementOptions& options, double tolerance);

}  // namespace crease

#pragma once

#include <string>
#include <vector>

#include "Registration/Landmarks.h"
#include "Transforms/Domains/RegionOfInterest.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

// Pairs of points before a body is deformed by them: where they lie, and what is strange about them.

/// Moves fixed points that lie outside the domain, but within `tolerance_mm` of it, onto its border, and their
/// partners with them: contours are curves, domains are polygons.
/// @param contour  numbers of the pairs that are looked at.
void place_on_border(Landmarks<2>& pairs, const std::vector<int>& contour,
                     const SplineBasis<2>& basis, double tolerance_mm);

/// Moves moving points that lie outside the moving image's body, but within `snap_mm` of it, onto its border.
/// @param name  what messages call the body.
/// @return a warning for each that lies clearly outside, and one for those that hardly do.
/// @throws InvalidInput naming the pair and its distance when it lies farther out.
std::vector<std::string> snap_moving_points(Landmarks<2>& pairs, const RegionOfInterest& body,
                                            const std::string& name = "the moving image's body",
                                            double snap_mm = 2);

/// Leaves out those of the pairs found in the images that any other lies on, in either image: a given pair, or one
/// found before. The two would tear the tissue between them.
/// @param found    numbers of the pairs in question; changed to match.
/// @param near_mm  how near is on it.
/// @return a warning for each.
std::vector<std::string> leave_out_found_pairs(Landmarks<2>& pairs, std::vector<int>& found,
                                               double near_mm = 2);

/// Warnings of pairs whose displacement is unlike the median of their five neighbours' by more than a share
/// of the body's width.
std::vector<std::string> strange_pairs(const Landmarks<2>& pairs, double width_mm,
                                       double share = 0.3);

}  // namespace crease

#pragma once

#include <string>
#include <vector>

#include "Core/Error.h"
#include "Registration/Landmarks.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// Moves fixed points that lie outside the domain, but within `snap_mm` of it, onto its border.
/// @return a warning for each that lies clearly outside, and one for those that hardly do.
/// @throws InvalidInput naming the pair and its distance when it lies farther out.
std::vector<std::string> snap_to_domain(Landmarks<2>& pairs, const SplineBasis<2>& basis,
                                        double snap_mm);

/// Pairs whose fixed points lie within `near_mm` of the border of a domain of triangles, in order along it:
/// one row per border ring, begun behind its widest gap. None for other bases.
std::vector<std::vector<int>> pairs_along_border(const Landmarks<2>& pairs,
                                                 const SplineBasis<2>& basis, double near_mm);

/// Checks that neither the fixed nor the moving points of a row of contour pairs, joined in their order,
/// cross: the map between them would fold.
/// @throws InvalidInput naming the four pairs of a crossing.
void check_no_crossing(const Landmarks<2>& pairs, const std::vector<int>& contour);

/// Checks that every connected part of the domain holds two pairs at least, so that none can float.
/// @param independent  numbers of the pairs that do not follow from the others.
/// @throws InvalidInput naming the place of a part that can.
void check_no_floating_part(const Landmarks<2>& pairs, const std::vector<int>& independent,
                            const SplineBasis<2>& basis);

}  // namespace crease

#pragma once

#include <utility>
#include <vector>

#include "Transforms/Domains/KnotNet.h"
#include "Transforms/Domains/MeshTopology.h"

namespace crease {

/// Checks that a knot net carries a basis that sums to one: degree 1 to 5; a conforming mesh of positive
/// simplices; clouds of the right size that begin with their vertex; every simplex of knots used together
/// positive; their intersection with an interior; knots of border vertices outside the domain.
///
/// In 3D the last condition is checked against the planes of the border faces, which suffices for
/// convex domains and clouds small against the gaps of others.
/// @throws InvalidInput naming the vertex, simplex or border edge at fault, and what to do.
template <int Dim>
void validate(const KnotNet<Dim>& net);
template <>
void validate<2>(const KnotNet<2>& net);
template <>
void validate<3>(const KnotNet<3>& net);

/// Border edges whose clouds' hull reaches into the domain, with the area inside, mm^2.
std::vector<std::pair<int, double>> border_clouds_inside(const KnotNet<2>& net,
                                                         const MeshTopology& topology);

}  // namespace crease

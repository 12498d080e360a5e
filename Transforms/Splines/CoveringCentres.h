#pragma once

#include <span>

#include "Core/Point.h"
#include "Core/Raster.h"

namespace crease {

/// Most points of the lattice of covering_centres().
template <int Dim>
inline constexpr int kMostLatticeCentres = Dim == 2 ? 400 : 512;

/// Centres for splines of a registration: a regular lattice over the raster's pixels, border included, about
/// `length` mm apart, and the landmarks, which thus are met by one control point each. A lattice point
/// within a quarter of their distance of a landmark is left out.
///
/// There are at most kMostLatticeCentres lattice points: where the length asks for more they are farther
/// apart.
/// @param landmarks  fixed points, mm; one that repeats an earlier one counts once.
/// @return Dim x n, the lattice first.
/// @throws InvalidInput when the raster is empty, the length is not a positive number, or a landmark is
/// not finite.
template <int Dim>
ControlPoints<Dim> covering_centres(const Raster<Dim>& raster, double length,
                                    std::span<const Point<Dim>> landmarks);

}  // namespace crease

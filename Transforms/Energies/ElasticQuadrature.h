#pragma once

#include <vector>

#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// Where an elastic energy is integrated.
enum class ElasticQuadrature {
  kCells,  ///< in every cell, where splines are polynomials: exact for St. Venant-Kirchhoff tissue
  /// Of triangular B-splines: at 12 points per triangle, whatever its cells: some ten times fewer points, but knot lines between
  /// them are not seen, and the stiffness is off by some per cent.
  kCheap
};

/// One element per triangle with the functions' gradients at the 12 points of a rule of degree 6, which is exact
/// where the triangle is one cell: for collapsed knots.
/// @throws InvalidInput for a basis without triangles.
template <int Dim>
std::vector<QuadratureElement<Dim>> cheap_elements(const SplineBasis<Dim>& basis);

extern template std::vector<QuadratureElement<2>> cheap_elements<2>(const SplineBasis<2>&);
extern template std::vector<QuadratureElement<3>> cheap_elements<3>(const SplineBasis<3>&);

}  // namespace crease

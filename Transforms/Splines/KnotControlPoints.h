#pragma once

#include <functional>
#include <span>
#include <vector>

#include "Transforms/Domains/SimplexMesh.h"
#include "Transforms/Splines/BPatchIndices.h"

namespace crease {

/// Which control point each local function of each simplex belongs to. Functions of neighbours that
/// take their knots from the same vertices, in the same numbers, share one: their control points agree
/// for every polynomial, and sharing them is what makes the spline continuous. There are as many as
/// Lagrange nodes: V + (n-1) E + C(n-1,2) T in 2D, V + (n-1) E + C(n-1,2) F + C(n-1,3) T in 3D.
///
/// The vertices' control points come first, numbered like the vertices.
template <int Dim>
class KnotControlPoints {
 public:
  KnotControlPoints(const SimplexMesh<Dim>& mesh, int degree);

  int count() const { return static_cast<int>(owners_.size()); }
  /// Control points of a simplex, by multi_index_position.
  std::span<const int> of_simplex(int simplex) const {
    return {&table_[static_cast<std::size_t>(simplex) * per_simplex_],
            static_cast<std::size_t>(per_simplex_)};
  }
  /// The simplex that lists the control point first, and its multi-index there.
  struct Owner {
    int simplex = 0;
    MultiIndex<Dim> beta{};
  };
  const Owner& owner(int control_point) const { return owners_[control_point]; }

 private:
  int per_simplex_;
  std::vector<int> table_;
  std::vector<Owner> owners_;
};

/// The symmetric multi-affine function of `degree` points that is the polynomial when all agree.
template <int Dim>
using PolarForm = std::function<double(std::span<const Point<Dim>> arguments)>;

/// Polar form of the monomial x^i y^j [z^k] for as many arguments as are given: the mean over all ways
/// to choose disjoint i, j [, k] of them of the products of these coordinates.
template <int Dim>
double monomial_polar_form(const std::array<int, Dim>& exponents,
                           std::span<const Point<Dim>> arguments);

}  // namespace crease

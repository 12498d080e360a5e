#pragma once

#include <span>
#include <vector>

#include "Core/Point.h"
#include "Transforms/AffineMap.h"

namespace crease {

/// The map of least bending that carries points p_i onto q_i: T(x) = A x + t + sum_i c_i U(|x -
/// p_i|), U(r) = r^2 log r. Building it solves one dense system, O(n^3). Source: F. L. Bookstein,
/// "Principal Warps", IEEE TPAMI 11(6), 1989.
class ThinPlateMap {
 public:
  /// @throws SolverError when points coincide or all lie on one line.
  ThinPlateMap(std::span<const Point<2>> from, std::span<const Point<2>> to);

  Point<2> operator()(const Point<2>& x) const;

 private:
  std::vector<Point<2>> from_;
  std::vector<Vector<2>> weights_;
  AffineMap<2> affine_;
};

}  // namespace crease

#pragma once

#include "Core/Point.h"

namespace crease {

/// x -> linear * x + offset (mm): the affine part of a transform.
template <int InDim, int OutDim = InDim>
struct AffineMap {
  Matrix<OutDim, InDim> linear = Matrix<OutDim, InDim>::Identity();
  Vector<OutDim> offset = Vector<OutDim>::Zero();

  Point<OutDim> operator()(const Point<InDim>& x) const { return linear * x + offset; }
  bool finite() const { return linear.allFinite() && offset.allFinite(); }
};

}  // namespace crease

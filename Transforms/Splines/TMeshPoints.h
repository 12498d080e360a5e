#pragma once

#include "Transforms/Splines/TMesh.h"

namespace crease {

/// The point some lines further along an axis.
inline TPoint moved(TPoint at, int axis, int steps) {
  at[axis] += steps;
  return at;
}

/// The crossing of the line `line` along `axis` with line `along` across it.
inline TPoint point_on(int axis, int line, int along) {
  TPoint at;
  at[axis] = along;
  at[1 - axis] = line;
  return at;
}

}  // namespace crease

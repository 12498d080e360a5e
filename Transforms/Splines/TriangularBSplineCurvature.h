#pragma once

#include <span>
#include <vector>

#include "Core/Point.h"
#include "Transforms/Splines/CurvatureGroups.h"

namespace crease {

/// A sample that stands for a block or a share of it, and in a strip the basis there.
struct BlockSample {
  int block = 0;
  int triangle = 0;                      ///< that holds the sample
  Point<2> position = Point<2>::Zero();  ///< mm
  bool in_core = false;
  float root_share = 1;      ///< square root of the block's share it stands for
  int start = 0, count = 0;  ///< strips: entries of BlockSamples
};
struct BlockSamples {
  std::vector<BlockSample> samples;
  std::vector<int> points;  ///< control points, ascending per sample
  std::vector<float> weights;
};

template <int Dim>
class TriangularBSplineBasis;

/// Blocks grouped by sets of control points: of a triangle, a pair across an edge, a vertex star.
CurvatureGroups curvature_groups(const TriangularBSplineBasis<2>& basis,
                                 std::span<const BlockSamples* const> parts);

}  // namespace crease

#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "Transforms/BoundGrid.h"

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

/// Adds sum_b G_b B_i(x_b) B_k(x_b) over blocks b to a Hessian. Blocks are grouped by sets of control
/// points (of a triangle, a pair across an edge, a vertex star); each group sums into a small dense
/// matrix and is scattered once.
class TriangularBSplineCurvature {
 public:
  TriangularBSplineCurvature(const TriangularBSplineBasis<2>& basis,
                             std::span<const BlockSamples* const> parts);

  /// @throws InvalidInput when the Hessian has another pattern than the basis.
  void add(const CurvatureBlocks<2>& blocks, double scale, BlockHessian<2>& hessian) const;

 private:
  struct Group {
    std::vector<int> control_points;  // ascending
    int stride = 0;
    std::vector<int> blocks;
    std::vector<float> weights;  // stride per block
    // Entry [i (i + 1) / 2 + k]: place of control point k in row i of the pattern, or none.
    std::vector<std::uint16_t> columns;
  };
  struct Place {  // of a control point in a group
    int group, position;
  };
  void find_columns(Group& group) const;
  void add_row(int control_point, const std::vector<std::vector<float>>& sums, double scale,
               BlockHessian<2>& hessian) const;

  std::shared_ptr<const HessianPattern> pattern_;
  std::vector<Group> groups_;
  std::vector<std::vector<Place>> places_;  // per control point, by group
};

}  // namespace crease

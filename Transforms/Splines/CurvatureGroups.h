#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "Transforms/BoundGrid.h"

namespace crease {

/// Adds sum_b G_b w_bi w_bk over blocks b to a Hessian. Samples that stand for blocks are grouped by sets
/// of control points; each group sums into a small dense matrix and is scattered once.
class CurvatureGroups {
 public:
  struct Group {
    std::vector<int> control_points;  ///< ascending
    int stride = 0;                   ///< their number, rounded up to a multiple of 8
    std::vector<int> blocks;          ///< of each sample
    /// `stride` weights per sample: values times the root of its share of the block.
    std::vector<float> weights;

    void set_control_points(std::vector<int> points, std::size_t num_samples) {
      control_points = std::move(points);
      stride = (static_cast<int>(control_points.size()) + 7) / 8 * 8;
      weights.assign(num_samples * stride, 0.0f);
    }
  };

  CurvatureGroups(std::shared_ptr<const HessianPattern> pattern, std::vector<Group> groups);

  /// @throws InvalidInput when the Hessian has another pattern.
  void add(const CurvatureBlocks<2>& blocks, double scale, BlockHessian<2>& hessian) const;

 private:
  struct Place {  // of a control point in a group
    int group, position;
  };
  std::vector<std::uint16_t> columns_of(const Group& group) const;
  void add_row(int control_point, const std::vector<std::vector<float>>& sums, double scale,
               BlockHessian<2>& hessian) const;

  std::shared_ptr<const HessianPattern> pattern_;
  std::vector<Group> groups_;
  // Per group, entry [i (i + 1) / 2 + k]: place of control point k in row i of the pattern, or none.
  std::vector<std::vector<std::uint16_t>> columns_;
  std::vector<std::vector<Place>> places_;  // per control point, by group
};

}  // namespace crease

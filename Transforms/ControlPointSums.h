#pragma once

#include <vector>

#include "Core/Point.h"

namespace crease {

/// Sums per control point that need memory only where something is added: blocks of consecutive
/// control points, made at the first touch. What a tile of rows of an adjoint adds up.
template <int Dim>
class ControlPointSums {
 public:
  ControlPointSums(int num_control_points, int block_size)
      : num_control_points_(num_control_points),
        block_size_(block_size),
        blocks_(static_cast<std::size_t>((num_control_points + block_size - 1) / block_size)) {}

  /// Sums of block b: component a of its c-th control point is entry a * block_size + c.
  double* block(int b) {
    auto& sums = blocks_[static_cast<std::size_t>(b)];
    if (sums.empty()) sums.assign(static_cast<std::size_t>(Dim * block_size_), 0.0);
    return sums.data();
  }
  void add(int control_point, int component, double value) {
    block(control_point / block_size_)[component * block_size_ + control_point % block_size_] +=
        value;
  }
  void add_to(Eigen::Ref<ControlPoints<Dim>> gradient) const {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (blocks_[b].empty()) continue;
      const int first = static_cast<int>(b) * block_size_;
      const int count = std::min(block_size_, num_control_points_ - first);
      const Eigen::Map<const Eigen::Matrix<double, Dim, Eigen::Dynamic, Eigen::RowMajor>> sums(
          blocks_[b].data(), Dim, block_size_);
      gradient.middleCols(first, count) += sums.leftCols(count);
    }
  }

 private:
  int num_control_points_;
  int block_size_;
  std::vector<std::vector<double>> blocks_;
};

}  // namespace crease

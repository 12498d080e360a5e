#pragma once

#include <span>
#include <vector>

#include "Transforms/BoundGrid.h"

namespace crease {

/// Blocks of samples along one axis of a tensor-product spline: which knot span the sample that stands
/// for each block lies in, and the products of the functions there.
struct TensorBlockAxis {
  TensorBlockAxis() = default;
  /// @param begin, end  covered samples; the others stand for no block.
  /// @param span        per sample.
  /// @param weights     per sample degree + 1 values.
  TensorBlockAxis(int degree, int num_spans, int begin, int end, std::span<const int> span,
                  std::span<const double> weights, int block_size);

  int taps = 1;       ///< functions per span: degree + 1
  int num_pairs = 1;  ///< unordered pairs of them
  int num_spans = 1;
  /// Blocks first_block[s] .. first_block[s + 1] - 1 lie in span s.
  std::vector<int> first_block;
  /// Entry [block][pair (r, r'), r <= r'] is w_r w_r'. Pairs in the order of pair_index().
  std::vector<double> products;

  int pair_index(int r, int other) const {
    if (r > other) std::swap(r, other);
    return r * taps - r * (r - 1) / 2 + (other - r);
  }
};

/// hessian(i, k) += scale * sum over blocks of G_b B_i(x_b) B_k(x_b): summed along the first axis, then
/// the second, then the third into one matrix per knot span, which is scattered once.
template <int Dim>
void add_tensor_curvature(const std::array<TensorBlockAxis, Dim>& axes,
                          const CurvatureBlocks<Dim>& blocks, double scale,
                          BlockHessian<Dim>& hessian);

}  // namespace crease

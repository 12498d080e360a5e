#include "Transforms/CurvaturePoints.h"

#include <algorithm>
#include <cmath>

#include "Core/Parallel.h"

namespace crease {

template <int Dim>
CurvaturePoints<Dim>::CurvaturePoints(const Raster<Dim>& raster, double step) {
  constexpr int kBlock = CurvatureBlocks<Dim>::kBlock;
  std::array<int, Dim> per_group, num_blocks, num_groups;
  int count = 1, blocks = 1;
  for (int a = 0; a < Dim; ++a) {
    per_group[a] = std::max(1, static_cast<int>(std::lround(step / (kBlock * raster.spacing[a]))));
    num_blocks[a] = (raster.size[a] + kBlock - 1) / kBlock;
    num_groups[a] = (num_blocks[a] + per_group[a] - 1) / per_group[a];
    blocks *= num_blocks[a];
    count *= num_groups[a];
  }
  points_.resize(Dim, count);
  for (int n = 0; n < count; ++n) {
    Vector<Dim> middle;
    for (int a = 0, rest = n; a < Dim; rest /= num_groups[a], ++a) {
      const int first = rest % num_groups[a] * per_group[a] * kBlock;
      middle[a] = 0.5 * (first + std::min(first + per_group[a] * kBlock, raster.size[a]) - 1);
    }
    points_.col(n) = raster.point(middle);
  }
  group_.resize(static_cast<std::size_t>(blocks));
  for (int b = 0; b < blocks; ++b) {
    int group = 0;
    for (int a = 0, rest = b, stride = 1; a < Dim; rest /= num_blocks[a], ++a) {
      group += rest % num_blocks[a] / per_group[a] * stride;
      stride *= num_groups[a];
    }
    group_[static_cast<std::size_t>(b)] = group;
  }
}

template <int Dim>
Eigen::VectorXd CurvaturePoints<Dim>::sums(const CurvatureBlocks<Dim>& blocks, int s) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(points_.cols());
  const std::vector<float>& component = blocks.sums[static_cast<std::size_t>(s)];
  for (std::size_t b = 0; b < group_.size(); ++b) result[group_[b]] += component[b];
  return result;
}

template <int Dim>
void add_dense_curvature(const CurvaturePoints<Dim>& points, const Eigen::MatrixXd& weights,
                         const CurvatureBlocks<Dim>& blocks, double scale,
                         BlockHessian<Dim>& hessian) {
  constexpr int kComponents = kNumSecondDerivatives<Dim>, kTile = 32;
  std::array<Eigen::VectorXd, kComponents> g;
  for (int s = 0; s < kComponents; ++s) g[s] = scale * points.sums(blocks, s);
  const Eigen::Index n = weights.rows();
  parallel_for((n + kTile - 1) / kTile, [&](std::int64_t tile) {
    const Eigen::Index first = tile * kTile, rows = std::min<Eigen::Index>(kTile, n - first);
    std::array<Eigen::MatrixXd, kComponents> product;
    for (int s = 0; s < kComponents; ++s) {
      const Eigen::MatrixXd scaled = weights.middleRows(first, rows) * g[s].asDiagonal();
      product[s].noalias() = scaled * weights.topRows(first + rows).transpose();
    }
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (Eigen::Index k = 0; k <= first + i; ++k) {
        Matrix<Dim> block;
        for (int a = 0, s = 0; a < Dim; ++a) {
          for (int b = a; b < Dim; ++b, ++s) block(a, b) = block(b, a) = product[s](i, k);
        }
        hessian.add(static_cast<int>(first + i), static_cast<int>(k), block);
      }
    }
  });
}

template class CurvaturePoints<2>;
template class CurvaturePoints<3>;
template void add_dense_curvature(const CurvaturePoints<2>&, const Eigen::MatrixXd&,
                                  const CurvatureBlocks<2>&, double, BlockHessian<2>&);
template void add_dense_curvature(const CurvaturePoints<3>&, const Eigen::MatrixXd&,
                                  const CurvatureBlocks<3>&, double, BlockHessian<3>&);

}  // namespace crease

#include "Transforms/Splines/CurvatureGroups.h"

#include <algorithm>

#include "Core/Cpu.h"
#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/Splines/TriangularBSplineGridKernels.h"

namespace crease {
namespace {

constexpr std::uint16_t kNone = 0xffff;  // functions of a group that do not meet have no entry

}  // namespace

CurvatureGroups::CurvatureGroups(std::shared_ptr<const HessianPattern> pattern,
                                 std::vector<Group> groups)
    : pattern_(std::move(pattern)),
      groups_(std::move(groups)),
      columns_(groups_.size()),
      places_(static_cast<std::size_t>(pattern_->size())) {
  parallel_for(std::ssize(groups_), [&](std::int64_t g) { columns_[g] = columns_of(groups_[g]); });
  for (int g = 0; g < static_cast<int>(groups_.size()); ++g) {
    const auto& points = groups_[g].control_points;
    for (int k = 0; k < static_cast<int>(points.size()); ++k) places_[points[k]].push_back({g, k});
  }
}

void CurvatureGroups::add(const CurvatureBlocks<2>& blocks, double scale,
                          BlockHessian<2>& hessian) const {
  const HessianPattern& pattern = hessian.pattern();
  if (&pattern != pattern_.get() &&
      (pattern.row_start() != pattern_->row_start() || pattern.columns() != pattern_->columns())) {
    throw InvalidInput("curvature of a triangular B-spline: the Hessian has another pattern");
  }
  const auto kernel = cpu_has_avx2() ? avx2::grid_block_products : baseline::grid_block_products;
  std::vector<std::vector<float>> sums(groups_.size());
  parallel_for(std::ssize(groups_), [&](std::int64_t g) {
    const Group& group = groups_[g];
    const auto size = group.control_points.size();
    sums[g].assign(size * 3 * group.stride, 0.0f);
    kernel(group.weights.data(), group.blocks.data(), static_cast<int>(group.blocks.size()),
           static_cast<int>(size), group.stride, blocks.sums[0].data(), blocks.sums[1].data(),
           blocks.sums[2].data(), sums[g].data());
  });
  constexpr int kRowsAtOnce = 64;
  const int rows = static_cast<int>(places_.size());
  parallel_for((rows + kRowsAtOnce - 1) / kRowsAtOnce, [&](std::int64_t part) {
    const int first = static_cast<int>(part) * kRowsAtOnce;
    for (int i = first; i < std::min(rows, first + kRowsAtOnce); ++i) {
      add_row(i, sums, scale, hessian);
    }
  });
}

std::vector<std::uint16_t> CurvatureGroups::columns_of(const Group& group) const {
  const auto& points = group.control_points;
  std::vector<std::uint16_t> columns;
  columns.reserve(points.size() * (points.size() + 1) / 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto begin = pattern_->columns().begin() + pattern_->row_start()[points[i]];
    const auto end = pattern_->columns().begin() + pattern_->row_start()[points[i] + 1];
    auto column = begin;
    for (std::size_t k = 0; k <= i; ++k) {
      while (column != end && *column < points[k]) ++column;
      const bool found = column != end && *column == points[k];
      columns.push_back(found ? static_cast<std::uint16_t>(column - begin) : kNone);
    }
  }
  return columns;
}

// Each row of the Hessian belongs to one call: its groups are added in their order.
void CurvatureGroups::add_row(int control_point, const std::vector<std::vector<float>>& sums,
                              double scale, BlockHessian<2>& hessian) const {
  const int row_start = pattern_->row_start()[control_point];
  for (const auto& [g, position] : places_[control_point]) {
    const Group& group = groups_[g];
    const float* s = &sums[g][static_cast<std::size_t>(3) * position * group.stride];
    const std::uint16_t* columns =
        &columns_[g][static_cast<std::size_t>(position) * (position + 1) / 2];
    for (int k = 0; k <= position; ++k) {
      const double xx = s[k], xy = s[group.stride + k], yy = s[2 * group.stride + k];
      if (columns[k] == kNone) {
        if (xx != 0.0 || yy != 0.0)
          pattern_->slot(control_point, group.control_points[k]);  // throws
        continue;
      }
      Matrix<2>& block = hessian.block(row_start + columns[k]);
      block(0, 0) += scale * xx;
      block(0, 1) += scale * xy;
      block(1, 0) += scale * xy;
      block(1, 1) += scale * yy;
    }
  }
}

}  // namespace crease

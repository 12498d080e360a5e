#include "Transforms/Splines/TriangularBSplineCurvature.h"

#include <algorithm>
#include <map>

#include "Core/Cpu.h"
#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"
#include "Transforms/Splines/TriangularBSplineGridKernels.h"

namespace crease {
namespace {

constexpr std::uint16_t kNone = 0xffff;  // functions of a group that do not meet have no entry

// The sets of control points that blocks are grouped by: one per triangle, per edge, per vertex.
class PointSets {
 public:
  explicit PointSets(const TriangularBSplineBasis<2>& basis) : basis_(basis) {
    const auto& mesh = basis.net().mesh;
    const int count = static_cast<int>(mesh.simplices.size());
    stars_.resize(mesh.vertices.size());
    std::map<std::pair<int, int>, int> edges;
    for (int t = 0; t < count; ++t) {
      triangles_.emplace_back();
      append(t, triangles_.back());
      for (int j = 0; j < 3; ++j) {
        const int a = mesh.simplices[t][j], b = mesh.simplices[t][(j + 1) % 3];
        append(t, stars_[a]);
        const auto [entry, is_new] =
            edges.try_emplace(std::minmax(a, b), static_cast<int>(edges_.size()));
        if (is_new) edges_.emplace_back();
        append(t, edges_[entry->second]);
        edges_of_.push_back(entry->second);
      }
    }
    for (auto* sets : {&triangles_, &edges_, &stars_}) {
      for (auto& set : *sets) {
        std::sort(set.begin(), set.end());
        set.erase(std::unique(set.begin(), set.end()), set.end());
      }
    }
  }

  int num_fixed() const {
    return static_cast<int>(triangles_.size() + edges_.size() + stars_.size());
  }
  const std::vector<int>& set(int number) const {
    const int t = static_cast<int>(triangles_.size()), e = static_cast<int>(edges_.size());
    if (number < t) return triangles_[number];
    return number < t + e ? edges_[number - t] : stars_[number - t - e];
  }

  // The smallest set near a triangle that holds all points (ascending); -1 when none does.
  int smallest(int triangle, std::span<const int> points) const {
    const auto holds = [&](const std::vector<int>& set) {
      return std::includes(set.begin(), set.end(), points.begin(), points.end());
    };
    const int t = static_cast<int>(triangles_.size()), e = static_cast<int>(edges_.size());
    if (holds(triangles_[triangle])) return triangle;
    for (int j = 0; j < 3; ++j) {
      const int edge = edges_of_[3 * triangle + j];
      if (holds(edges_[edge])) return t + edge;
    }
    for (int v : basis_.net().mesh.simplices[triangle]) {
      if (holds(stars_[v])) return t + e + v;
    }
    return -1;
  }

 private:
  void append(int triangle, std::vector<int>& set) const {
    const auto points = basis_.control_points_of(triangle);
    set.insert(set.end(), points.begin(), points.end());
  }

  const TriangularBSplineBasis<2>& basis_;
  std::vector<std::vector<int>> triangles_, edges_, stars_;
  std::vector<int> edges_of_;
};

// A block's sample, and where its part keeps its row.
struct Member {
  const BlockSamples* part;
  const BlockSample* sample;
};

}  // namespace

TriangularBSplineCurvature::TriangularBSplineCurvature(const TriangularBSplineBasis<2>& basis,
                                                       std::span<const BlockSamples* const> parts)
    : pattern_(basis.pattern()) {
  const PointSets sets(basis);
  std::vector<std::vector<Member>> fixed(sets.num_fixed());
  std::map<std::vector<int>, std::vector<Member>> others;  // clouds that reach past the neighbours
  for (const BlockSamples* part : parts) {
    for (const BlockSample& sample : part->samples) {
      const auto points = std::span(part->points).subspan(sample.start, sample.count);
      const int number = sample.in_core ? sample.triangle : sets.smallest(sample.triangle, points);
      auto& members = number >= 0 ? fixed[number] : others[{points.begin(), points.end()}];
      members.push_back({part, &sample});
    }
  }
  std::vector<const std::vector<Member>*> members;
  for (int s = 0; s < sets.num_fixed(); ++s) {
    if (fixed[s].empty()) continue;
    groups_.push_back({sets.set(s), 0, {}, {}, {}});
    members.push_back(&fixed[s]);
  }
  for (const auto& [points, of_set] : others) {
    groups_.push_back({points, 0, {}, {}, {}});
    members.push_back(&of_set);
  }
  parallel_for(std::ssize(groups_), [&](std::int64_t g) {
    Group& group = groups_[g];
    const auto& points = group.control_points;
    group.stride = (static_cast<int>(points.size()) + 7) / 8 * 8;
    group.weights.assign(members[g]->size() * group.stride, 0.0f);
    float* row = group.weights.data();
    const auto place = [&](int point) {
      return std::lower_bound(points.begin(), points.end(), point) - points.begin();
    };
    for (const auto& [part, sample] : *members[g]) {
      group.blocks.push_back(sample->block);
      if (sample->in_core) {
        const auto values = basis.patch(sample->triangle).evaluate(sample->position, 0);
        const auto numbers = basis.control_points_of(sample->triangle);
        for (std::size_t k = 0; k < numbers.size(); ++k) {
          row[place(numbers[k])] = sample->root_share * static_cast<float>(values(k, 0));
        }
      } else {
        for (int k = sample->start; k < sample->start + sample->count; ++k) {
          row[place(part->points[k])] = sample->root_share * part->weights[k];
        }
      }
      row += group.stride;
    }
    find_columns(group);
  });
  places_.resize(basis.num_control_points());
  for (int g = 0; g < static_cast<int>(groups_.size()); ++g) {
    const auto& points = groups_[g].control_points;
    for (int k = 0; k < static_cast<int>(points.size()); ++k) places_[points[k]].push_back({g, k});
  }
}

void TriangularBSplineCurvature::add(const CurvatureBlocks<2>& blocks, double scale,
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

void TriangularBSplineCurvature::find_columns(Group& group) const {
  const auto& points = group.control_points;
  group.columns.reserve(points.size() * (points.size() + 1) / 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto begin = pattern_->columns().begin() + pattern_->row_start()[points[i]];
    const auto end = pattern_->columns().begin() + pattern_->row_start()[points[i] + 1];
    auto column = begin;
    for (std::size_t k = 0; k <= i; ++k) {
      while (column != end && *column < points[k]) ++column;
      const bool found = column != end && *column == points[k];
      group.columns.push_back(found ? static_cast<std::uint16_t>(column - begin) : kNone);
    }
  }
}

// Each row of the Hessian belongs to one call: its groups are added in their order.
void TriangularBSplineCurvature::add_row(int control_point,
                                         const std::vector<std::vector<float>>& sums, double scale,
                                         BlockHessian<2>& hessian) const {
  const int row_start = pattern_->row_start()[control_point];
  for (const auto& [g, position] : places_[control_point]) {
    const Group& group = groups_[g];
    const float* s = &sums[g][static_cast<std::size_t>(3) * position * group.stride];
    const std::uint16_t* columns =
        &group.columns[static_cast<std::size_t>(position) * (position + 1) / 2];
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

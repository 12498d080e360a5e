#include "Transforms/Splines/TriangularBSplineCurvature.h"

#include <algorithm>
#include <map>

#include "Core/Parallel.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

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

CurvatureGroups curvature_groups(const TriangularBSplineBasis<2>& basis,
                                 std::span<const BlockSamples* const> parts) {
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
  std::vector<CurvatureGroups::Group> groups;
  std::vector<const std::vector<Member>*> members;
  const auto add_group = [&](const std::vector<int>& points, const std::vector<Member>& of_set) {
    groups.emplace_back().set_control_points(points, of_set.size());
    members.push_back(&of_set);
  };
  for (int s = 0; s < sets.num_fixed(); ++s) {
    if (!fixed[s].empty()) add_group(sets.set(s), fixed[s]);
  }
  for (const auto& [points, of_set] : others) add_group(points, of_set);
  parallel_for(std::ssize(groups), [&](std::int64_t g) {
    CurvatureGroups::Group& group = groups[g];
    const auto& points = group.control_points;
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
  });
  return {basis.pattern(), std::move(groups)};
}

}  // namespace crease

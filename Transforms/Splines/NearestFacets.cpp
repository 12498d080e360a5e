#include "Transforms/Splines/NearestFacets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>

#include "Core/Error.h"
#include "Transforms/Domains/Polygon.h"

namespace crease {
namespace {

// By dimension.
constexpr std::size_t kFewFacets[4] = {0, 0, 8, 16};  // are searched one by one
constexpr int kChildren[4] = {0, 2, 4, 8};
constexpr int kMostDepth[4] = {0, 0, 7, 5};

Point<2> closest_on(const Point<2>& x, const std::array<Point<2>, 2>& edge) {
  return closest_point_on_segment(x, edge[0], edge[1]);
}

Point<3> closest_on(const Point<3>& x, const std::array<Point<3>, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const auto on_edge = [&](const Point<3>& p, const Point<3>& q) -> Point<3> {
    const Vector<3> d = q - p;
    return p + std::clamp((x - p).dot(d) / d.squaredNorm(), 0.0, 1.0) * d;
  };
  const Vector<3> normal = (b - a).cross(c - a);
  const auto left_of = [&](const Point<3>& p, const Point<3>& q) {
    return normal.dot((q - p).cross(x - p)) >= 0.0;
  };
  if (left_of(a, b) && left_of(b, c) && left_of(c, a)) {
    return x - (x - a).dot(normal) / normal.squaredNorm() * normal;
  }
  Point<3> best = on_edge(a, b);
  for (const Point<3>& candidate : {on_edge(b, c), on_edge(c, a)}) {
    if ((candidate - x).squaredNorm() < (best - x).squaredNorm()) best = candidate;
  }
  return best;
}

/// The child that holds x, as bits of the axes; the box shrinks to it.
template <int Dim>
int descend(const Point<Dim>& x, Box<Dim>& box) {
  int child = 0;
  for (int a = 0; a < Dim; ++a) {
    const double middle = 0.5 * (box.lower[a] + box.upper[a]);
    if (x[a] > middle) {
      child |= 1 << a;
      box.lower[a] = middle;
    } else {
      box.upper[a] = middle;
    }
  }
  return child;
}

}  // namespace

template <int Dim>
NearestFacets<Dim>::NearestFacets(const SimplexMesh<Dim>& mesh, const std::vector<Facet>& facets) {
  for (const Facet& facet : facets) {
    auto& corners = corners_.emplace_back();
    for (int j = 0; j < Dim; ++j) {
      corners[j] = mesh.vertices[facet[j]];
      box_.add(corners[j]);
    }
  }
  if (corners_.empty()) return;
  const Vector<Dim> around = Vector<Dim>::Constant(box_.size().maxCoeff());
  box_.lower -= around;
  box_.upper += around;
  nodes_.emplace_back().facets.resize(corners_.size());
  std::iota(nodes_[0].facets.begin(), nodes_[0].facets.end(), 0);
  split(0, box_, 0);
}

// A facet farther from the middle than the nearest one by more than the diagonal is nearest nowhere in a box.
template <int Dim>
void NearestFacets<Dim>::split(int node, const Box<Dim>& box, int depth) {
  std::vector<int>& facets = nodes_[node].facets;
  const Point<Dim> middle = 0.5 * (box.lower + box.upper);
  std::vector<double> distance;
  for (int f : facets) distance.push_back((closest_on(middle, corners_[f]) - middle).norm());
  const double farthest =
      (1 + 1e-12) * (*std::ranges::min_element(distance) + box.diagonal()) + 1e-300;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < facets.size(); ++k) {
    if (distance[k] <= farthest) facets[kept++] = facets[k];
  }
  facets.resize(kept);
  if (kept <= kFewFacets[Dim] || depth >= kMostDepth[Dim]) return;
  const int first = static_cast<int>(nodes_.size());
  std::vector<int> to_share = facets;  // nodes move as they grow in number
  if (node > 0) facets.clear();        // the first is asked from far away
  nodes_[node].first_child = first;
  nodes_.resize(nodes_.size() + kChildren[Dim]);
  for (int c = 0; c < kChildren[Dim]; ++c) {
    Box<Dim> part = box;
    Point<Dim> within;
    for (int a = 0; a < Dim; ++a) within[a] = (c >> a & 1) != 0 ? box.upper[a] : box.lower[a];
    descend<Dim>(within, part);
    nodes_[first + c].facets = to_share;
    split(first + c, part, depth + 1);
  }
}

template <int Dim>
typename NearestFacets<Dim>::Found NearestFacets<Dim>::find(const Point<Dim>& x) const {
  if (nodes_.empty()) throw InvalidInput("NearestFacets: there are no facets.");
  int node = 0;
  if (box_.contains(x)) {
    Box<Dim> box = box_;
    while (nodes_[node].first_child >= 0) node = nodes_[node].first_child + descend<Dim>(x, box);
  }
  Found found;
  double least = std::numeric_limits<double>::infinity();
  for (int f : nodes_[node].facets) {
    const Point<Dim> candidate = closest_on(x, corners_[f]);
    const double d = (candidate - x).squaredNorm();
    if (found.facet >= 0 && !(d < least)) continue;
    least = d;
    found = {f, candidate};
  }
  return found;
}

template class NearestFacets<2>;
template class NearestFacets<3>;

}  // namespace crease

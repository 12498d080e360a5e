#include "Transforms/Domains/CreaseBands.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "Transforms/Domains/ConvexPolygon.h"
#include "Transforms/Domains/MeshTopology.h"

namespace crease {
namespace {

bool inside(const Polyline& hull, const Point<2>& p) {
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Point<2>& next = hull[i + 1 == hull.size() ? 0 : i + 1];
    if (cross(next - hull[i], p - hull[i]) < 0) return false;
  }
  return hull.size() >= 3;
}

/// Triangles that touch one of the vertices, or a neighbour of it.
std::set<int> triangles_near(const KnotNet<2>& net, const std::vector<std::vector<int>>& at_vertex,
                             const std::array<int, 2>& vertices) {
  std::set<int> result;
  for (int v : vertices) {
    for (int t : at_vertex[v]) {
      for (int w : net.mesh.simplices[t]) {
        result.insert(at_vertex[w].begin(), at_vertex[w].end());
      }
    }
  }
  return result;
}

}  // namespace

CreaseBands::CreaseBands(const KnotNet<2>& net) {
  const auto& mesh = net.mesh;
  in_triangle_.resize(mesh.simplices.size());
  std::vector<std::vector<int>> at_vertex(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto& s = mesh.simplices[t];
    corners_.push_back({mesh.vertices[s[0]], mesh.vertices[s[1]], mesh.vertices[s[2]]});
    for (int v : s) at_vertex[v].push_back(static_cast<int>(t));
  }
  for (const auto& edge : net.crease_edges) {
    const int number = static_cast<int>(bands_.size());
    Polyline knots = net.clouds[edge.vertices[0]];
    const auto& other = net.clouds[edge.vertices[1]];
    knots.insert(knots.end(), other.begin(), other.end());
    bands_.push_back({edge.vertices, edge.body_side, convex_hull(knots)});
    Polyline& hull = bands_.back().hull;
    const double length2 =
        (mesh.vertices[edge.vertices[0]] - mesh.vertices[edge.vertices[1]]).squaredNorm();
    if (hull.size() < 3 || signed_area(hull) <= 1e-12 * length2) {
      hull.clear();
      continue;
    }
    for (int t : triangles_near(net, at_vertex, edge.vertices)) {
      const Polyline common = clipped_by_convex(corners_[t], hull);
      if (common.size() >= 3 && signed_area(common) > 1e-14 * length2) {
        in_triangle_[t].push_back(number);
      }
    }
  }
}

bool CreaseBands::contains(int triangle, const Point<2>& p) const {
  const auto& near = in_triangle_[triangle];
  return std::any_of(near.begin(), near.end(), [&](int b) { return inside(bands_[b].hull, p); });
}

bool CreaseBands::contains_two_sided(int triangle, const Point<2>& p) const {
  const auto& near = in_triangle_[triangle];
  return std::any_of(near.begin(), near.end(),
                     [&](int b) { return !bands_[b].body_side && inside(bands_[b].hull, p); });
}

double CreaseBands::area_in(int triangle, bool only_body_side) const {
  const Polyline whole(corners_[triangle].begin(), corners_[triangle].end());
  std::vector<Polyline> outside{whole};
  for (int b : in_triangle_[triangle]) {
    if (only_body_side && !bands_[b].body_side) continue;
    std::vector<Polyline> rest;
    for (const auto& part : outside) {
      for (auto& piece : convex_difference(part, bands_[b].hull)) rest.push_back(std::move(piece));
    }
    outside = std::move(rest);
  }
  double area = signed_area(whole);
  for (const auto& part : outside) area -= signed_area(part);
  return std::max(0.0, area);
}

}  // namespace crease

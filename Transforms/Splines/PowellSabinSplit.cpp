#include "Transforms/Splines/PowellSabinSplit.h"

#include <cmath>

#include "Core/Error.h"
#include "Transforms/Domains/Polygon.h"

namespace crease {
namespace {

const SimplexMesh<2>& checked(const SimplexMesh<2>& mesh) {
  if (mesh.simplices.empty()) throw InvalidInput("Powell-Sabin split: the mesh has no triangle.");
  if (!mesh.regions.empty() && mesh.regions.size() != mesh.simplices.size()) {
    throw InvalidInput(message("Powell-Sabin split: ", mesh.regions.size(), " regions for ",
                               mesh.simplices.size(), " triangles; give one each or none."));
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!mesh.vertices[v].allFinite()) {
      throw InvalidInput(message("Powell-Sabin split: vertex ", v, " is not a finite point."));
    }
  }
  return mesh;
}

// The side of an edge, seen from its lower to its higher vertex, and the square of its length.
struct EdgeFrame {
  Point<2> start;
  Vector<2> along;

  double height(const Point<2>& p) const { return cross(along, p - start); }
  double foot(const Point<2>& p) const { return (p - start).dot(along) / along.squaredNorm(); }
};

}  // namespace

PowellSabinSplit::PowellSabinSplit(const SimplexMesh<2>& mesh) : topology_(checked(mesh)) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (topology_.triangles_at(static_cast<int>(v)).empty()) {
      throw InvalidInput(
          message("Powell-Sabin split: vertex ", v, " belongs to no triangle; leave it out."));
    }
  }
  set_centres(mesh);
  set_edge_points(mesh);
}

void PowellSabinSplit::set_centres(const SimplexMesh<2>& mesh) {
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto& s = mesh.simplices[t];
    const auto& p = mesh.vertices;
    Vector<3> opposite;
    for (int k = 0; k < 3; ++k) opposite[k] = (p[s[(k + 1) % 3]] - p[s[(k + 2) % 3]]).norm();
    const double longest = opposite.maxCoeff();
    if (!(cross(p[s[1]] - p[s[0]], p[s[2]] - p[s[0]]) > 1e-12 * longest * longest)) {
      throw InvalidInput(message("Powell-Sabin split: triangle ", t, " (vertices ", s[0], ", ",
                                 s[1], ", ", s[2], ") is folded or flat."));
    }
    const Vector<3> weights = opposite / opposite.sum();
    centre_weights_.push_back(weights);
    centres_.emplace_back(weights[0] * p[s[0]] + weights[1] * p[s[1]] + weights[2] * p[s[2]]);
    edges_of_.push_back({topology_.edge_between(s[0], s[1]), topology_.edge_between(s[1], s[2]),
                         topology_.edge_between(s[2], s[0])});
  }
}

void PowellSabinSplit::set_edge_points(const SimplexMesh<2>& mesh) {
  for (const auto& edge : topology_.edges()) {
    const auto [a, b] = edge.vertices;
    const EdgeFrame frame{mesh.vertices[a], mesh.vertices[b] - mesh.vertices[a]};
    double foot = 0.5;
    if (edge.triangles[1] >= 0) {
      const Point<2>&p = centres_[edge.triangles[0]], &q = centres_[edge.triangles[1]];
      const double above = frame.height(p), below = -frame.height(q);
      if (!(above * below > 0)) {
        throw InvalidInput(message("Powell-Sabin split: triangles ", edge.triangles[0], " and ",
                                   edge.triangles[1],
                                   " lie on the same side of their edge between vertices ", a,
                                   " and ", b, "; the mesh is folded."));
      }
      foot = (frame.foot(p) * below + frame.foot(q) * above) / (above + below);
    }
    shares_.push_back(1 - foot);
    edge_points_.emplace_back((1 - foot) * mesh.vertices[a] + foot * mesh.vertices[b]);
  }
}

}  // namespace crease

#include "Transforms/Domains/DomainMesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "Core/Error.h"
#include "Transforms/Domains/MeshTopology.h"

namespace crease {
namespace {

constexpr double kOnEdge = 1e-9;  // of the mesh's extent

class LineWalker {
 public:
  LineWalker(const SimplexMesh<2>& mesh, const MeshTopology& topology)
      : mesh_(mesh), topology_(topology) {
    Point<2> lower = mesh.vertices[0], upper = lower;
    for (const auto& p : mesh.vertices) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
    tolerance_ = kOnEdge * (upper - lower).norm();
  }

  int vertex_at(const Point<2>& p) const {
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
      if ((mesh_.vertices[v] - p).norm() <= tolerance_) return static_cast<int>(v);
    }
    return -1;
  }

  /// The neighbour of `from` on the segment towards `to`; -1: none.
  int step(int from, int to) const {
    const Point<2>&p = mesh_.vertices[from], &q = mesh_.vertices[to];
    for (int e : topology_.edges_at(from)) {
      const int next = topology_.other_end(e, from);
      const Point<2>& r = mesh_.vertices[next];
      const bool forward = (r - p).dot(q - p) > 0;
      if (forward && (r - closest_point_on_segment(r, p, q)).norm() <= tolerance_) return next;
    }
    return -1;
  }

 private:
  const SimplexMesh<2>& mesh_;
  const MeshTopology& topology_;
  double tolerance_ = 0;
};

std::vector<int> walk(const LineWalker& walker, const FeatureLine& line, std::size_t number) {
  std::vector<int> vertices;
  const auto fail = [&](std::size_t i, const char* what) {
    throw InvalidInput(message("attach_feature_lines: line ", number + 1, ", point ", i + 1, " (",
                               line.points[i].x(), ", ", line.points[i].y(), ") mm ", what));
  };
  std::vector<int> corners;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    corners.push_back(walker.vertex_at(line.points[i]));
    if (corners.back() < 0) fail(i, "is no vertex of the mesh.");
  }
  if (line.closed) corners.push_back(corners.front());
  vertices.push_back(corners.front());
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    while (vertices.back() != corners[i + 1]) {
      const int next = walker.step(vertices.back(), corners[i + 1]);
      if (next < 0) fail(i, "starts a stretch that does not run along the mesh's edges.");
      vertices.push_back(next);
    }
  }
  if (line.closed) vertices.pop_back();
  return vertices;
}

}  // namespace

std::array<double, 3> corner_angles_deg(const SimplexMesh<2>& mesh,
                                        const std::array<int, 3>& triangle) {
  std::array<double, 3> angles{};
  for (int k = 0; k < 3; ++k) {
    const Point<2>& p = mesh.vertices[triangle[k]];
    angles[k] = turn_angle(mesh.vertices[triangle[(k + 1) % 3]] - p,
                           mesh.vertices[triangle[(k + 2) % 3]] - p) *
                180 / std::numbers::pi;
  }
  return angles;
}

MeshFigures mesh_figures(const SimplexMesh<2>& mesh) {
  MeshFigures figures;
  const MeshTopology topology(mesh);
  figures.num_vertices = static_cast<int>(mesh.vertices.size());
  figures.num_edges = static_cast<int>(topology.edges().size());
  figures.num_triangles = static_cast<int>(mesh.simplices.size());
  figures.smallest_edge = std::numeric_limits<double>::infinity();
  for (const auto& edge : topology.edges()) {
    const double length =
        (mesh.vertices[edge.vertices[0]] - mesh.vertices[edge.vertices[1]]).norm();
    figures.smallest_edge = std::min(figures.smallest_edge, length);
    figures.largest_edge = std::max(figures.largest_edge, length);
    figures.mean_edge += length / figures.num_edges;
  }
  figures.smallest_angle_deg = 180;
  for (const auto& triangle : mesh.simplices) {
    for (double angle : corner_angles_deg(mesh, triangle)) {
      figures.smallest_angle_deg = std::min(figures.smallest_angle_deg, angle);
    }
    const Point<2>& p = mesh.vertices[triangle[0]];
    figures.area += 0.5 * cross(mesh.vertices[triangle[1]] - p, mesh.vertices[triangle[2]] - p);
  }
  return figures;
}

DomainMesh attach_feature_lines(SimplexMesh<2> mesh, const std::vector<FeatureLine>& lines) {
  check_feature_lines(lines);
  check_kinds_available(lines);
  const auto labelled = with_body_labels(lines);
  const MeshTopology topology(mesh);
  const LineWalker walker(mesh, topology);
  DomainMesh domain;
  for (std::size_t l = 0; l < labelled.size(); ++l) {
    const FeatureLine line =
        body_side(labelled[l]) == BodySide::kRight ? reversed(labelled[l]) : labelled[l];
    FeatureChain chain;
    chain.vertices = walk(walker, line, l);
    chain.closed = line.closed;
    chain.kind = line.kind;
    chain.body = body_side(line);
    chain.corner = line.corner;
    chain.name = line.name;
    domain.chains.push_back(std::move(chain));
  }
  const BodyRegions regions(labelled);
  mesh.regions.resize(mesh.simplices.size());
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto& s = mesh.simplices[t];
    mesh.regions[t] =
        regions.label_at((mesh.vertices[s[0]] + mesh.vertices[s[1]] + mesh.vertices[s[2]]) / 3);
  }
  domain.mesh = std::move(mesh);
  return domain;
}

}  // namespace crease

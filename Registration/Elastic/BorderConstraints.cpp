#include "Registration/Elastic/BorderConstraints.h"

#include <set>

#include "Core/Error.h"
#include "Transforms/Domains/MeshTopology.h"

namespace crease {
namespace {

constexpr int kCorners = 3;

/// The control point of an edge of a triangle of degree 2, by the places of its ends among the corners.
int edge_control_point(const TriangularBSplineBasis<2>& basis, int triangle, int i, int k) {
  MultiIndex<2> beta{};
  beta[i] = beta[k] = 1;
  return basis.control_points_of(triangle)[multi_index_position<2>(beta)];
}

/// Vertices have the numbers of their control points.
std::set<int> border_control_points(const TriangularBSplineBasis<2>& basis) {
  const SimplexMesh<2>& mesh = basis.net().mesh;
  const MeshTopology topology(mesh);
  std::set<int> border;
  for (const MeshTopology::Edge& edge : topology.edges()) {
    if (edge.triangles[1] >= 0) continue;
    border.insert(edge.vertices.begin(), edge.vertices.end());
    const auto& corners = mesh.simplices[edge.triangles[0]];
    for (int i = 0; i < kCorners; ++i) {
      const int k = (i + 1) % kCorners;
      if (std::minmax(corners[i], corners[k]) != std::minmax(edge.vertices[0], edge.vertices[1])) {
        continue;
      }
      border.insert(edge_control_point(basis, edge.triangles[0], i, k));
    }
  }
  return border;
}

void require_quadratic(const TriangularBSplineBasis<2>& basis) {
  if (basis.degree() == 2) return;
  throw InvalidInput(message("values on edges: the splines are of degree ", basis.degree(),
                             "; they are for degree 2."));
}

}  // namespace

ControlPoints<2> interpolate_on_edges(const TriangularBSplineBasis<2>& basis,
                                      const DisplacementFunction<2>& displacement) {
  require_quadratic(basis);
  const SimplexMesh<2>& mesh = basis.net().mesh;
  ControlPoints<2> phi = ControlPoints<2>::Zero(2, basis.num_control_points());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    phi.col(static_cast<Eigen::Index>(v)) = displacement(mesh.vertices[v]);
  }
  for (int t = 0; t < static_cast<int>(mesh.simplices.size()); ++t) {
    const auto& corners = mesh.simplices[t];
    for (int i = 0; i < kCorners; ++i) {
      const int k = (i + 1) % kCorners;
      const Point<2> middle = 0.5 * (mesh.vertices[corners[i]] + mesh.vertices[corners[k]]);
      phi.col(edge_control_point(basis, t, i, k)) =
          2 * displacement(middle) - 0.5 * (phi.col(corners[i]) + phi.col(corners[k]));
    }
  }
  return phi;
}

LinearConstraints border_constraints(const TriangularBSplineBasis<2>& basis,
                                     const ControlPoints<2>& control_points) {
  require_quadratic(basis);
  const std::set<int> border = border_control_points(basis);
  LinearConstraints constraints;
  constraints.C.resize(std::ssize(border), basis.num_control_points());
  constraints.d.resize(std::ssize(border), 2);
  Eigen::Index row = 0;
  for (const int i : border) {
    constraints.C.insert(row, i) = 1;
    constraints.d.row(row) = control_points.col(i).transpose();
    constraints.names.push_back(message("border point ", ++row));
  }
  constraints.C.makeCompressed();
  return constraints;
}

}  // namespace crease

#include "Transforms/Domains/KnotNetCheck.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/Domains/ConvexPolygon.h"
#include "Transforms/Domains/KnotTriangles.h"
#include "Transforms/Domains/TetrahedronKnots.h"

namespace crease {
namespace {

template <int Dim>
void check_clouds(const KnotNet<Dim>& net) {
  if (net.degree < 1 || net.degree > 5) {
    throw InvalidInput(message("knot net: degree ", net.degree, " is not between 1 and 5."));
  }
  if (net.mesh.simplices.empty()) throw InvalidInput("knot net: the mesh has no simplex.");
  if (net.clouds.size() != net.mesh.vertices.size()) {
    throw InvalidInput(message("knot net: ", net.clouds.size(), " clouds for ",
                               net.mesh.vertices.size(), " vertices."));
  }
  if (!net.mesh.regions.empty() && net.mesh.regions.size() != net.mesh.simplices.size()) {
    throw InvalidInput(message("knot net: ", net.mesh.regions.size(), " regions for ",
                               net.mesh.simplices.size(), " simplices."));
  }
  const auto size = static_cast<std::size_t>(net.degree);
  for (std::size_t v = 0; v < net.clouds.size(); ++v) {
    const auto& cloud = net.clouds[v];
    if (cloud.size() != size) {
      throw InvalidInput(message("knot net: vertex ", v, " has ", cloud.size(), " knots; degree ",
                                 net.degree, " needs ", size, ", the vertex included."));
    }
    for (const auto& knot : cloud) {
      if (!knot.allFinite())
        throw InvalidInput(message("knot net: vertex ", v,
                                   " has a knot that is "
                                   "not finite."));
    }
    if (cloud[0] != net.mesh.vertices[v]) {
      throw InvalidInput(message("knot net: the first knot of vertex ", v, " is not the vertex."));
    }
  }
}

TriangleClouds clouds_of(const KnotNet<2>& net, std::size_t triangle) {
  const auto& s = net.mesh.simplices[triangle];
  return {net.clouds[s[0]], net.clouds[s[1]], net.clouds[s[2]]};
}

void check_triangle(const KnotNet<2>& net, std::size_t t) {
  const auto& s = net.mesh.simplices[t];
  const auto& p = net.mesh.vertices;
  const double twice_area = cross(p[s[1]] - p[s[0]], p[s[2]] - p[s[0]]);
  const double longest =
      std::max({(p[s[1]] - p[s[0]]).squaredNorm(), (p[s[2]] - p[s[1]]).squaredNorm(),
                (p[s[0]] - p[s[2]]).squaredNorm()});
  if (!(twice_area > 1e-12 * longest)) {
    throw InvalidInput(message("knot net: triangle ", t, " (vertices ", s[0], ", ", s[1], ", ",
                               s[2], ") is folded or flat."));
  }
  const auto clouds = clouds_of(net, t);
  const double smallest = smallest_knot_triangle(clouds, net.degree);
  if (!(smallest > 1e-12)) {
    throw InvalidInput(message("knot net: knots of triangle ", t, " (vertices ", s[0], ", ", s[1],
                               ", ", s[2], ") span a triangle of ", smallest,
                               " times its area; make its clouds smaller."));
  }
  if (!has_core(clouds, net.degree)) {
    throw InvalidInput(message("knot net: the triangles spanned by the knots of triangle ", t,
                               " have no common interior; make its clouds smaller."));
  }
}

}  // namespace

std::vector<std::pair<int, double>> border_clouds_inside(const KnotNet<2>& net,
                                                         const MeshTopology& topology) {
  // Only triangles with a border vertex can be reached through the border.
  struct Near {
    Point<2> lower, upper;
    Polyline corners;
  };
  std::vector<Near> near;
  for (const auto& s : net.mesh.simplices) {
    if (std::none_of(s.begin(), s.end(), [&](int v) { return topology.on_border(v); })) continue;
    const auto& p = net.mesh.vertices;
    near.push_back({p[s[0]].cwiseMin(p[s[1]]).cwiseMin(p[s[2]]),
                    p[s[0]].cwiseMax(p[s[1]]).cwiseMax(p[s[2]]),
                    {p[s[0]], p[s[1]], p[s[2]]}});
  }
  std::vector<std::pair<int, double>> result;
  for (std::size_t e = 0; e < topology.edges().size(); ++e) {
    const auto& edge = topology.edges()[e];
    if (edge.triangles[1] >= 0) continue;
    Polyline knots = net.clouds[edge.vertices[0]];
    const auto& other = net.clouds[edge.vertices[1]];
    knots.insert(knots.end(), other.begin(), other.end());
    const Polyline hull = convex_hull(knots);
    if (hull.size() < 3) continue;
    Point<2> lower = hull[0], upper = hull[0];
    for (const auto& p : hull) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
    double area = 0;
    for (const auto& triangle : near) {
      if ((triangle.lower.array() > upper.array()).any()) continue;
      if ((triangle.upper.array() < lower.array()).any()) continue;
      const Polyline common = clipped_by_convex(triangle.corners, hull);
      if (common.size() >= 3) area += signed_area(common);
    }
    const double length2 =
        (net.mesh.vertices[edge.vertices[0]] - net.mesh.vertices[edge.vertices[1]]).squaredNorm();
    if (area > 1e-9 * length2) result.emplace_back(static_cast<int>(e), area);
  }
  return result;
}

template <>
void validate<2>(const KnotNet<2>& net) {
  check_clouds(net);
  const MeshTopology topology(net.mesh);
  for (std::size_t t = 0; t < net.mesh.simplices.size(); ++t) check_triangle(net, t);
  const auto inside = border_clouds_inside(net, topology);
  if (!inside.empty()) {
    const auto& v = topology.edges()[inside[0].first].vertices;
    throw InvalidInput(message("knot net: knots of the border edge between vertices ", v[0],
                               " and ", v[1], " reach ", inside[0].second,
                               " mm^2 into the domain; border knots must lie outside."));
  }
  for (const auto& edge : net.crease_edges) {
    const auto& [a, b] = edge.vertices;
    const int count = static_cast<int>(net.mesh.vertices.size());
    if (std::min(a, b) < 0 || std::max(a, b) >= count || topology.edge_between(a, b) < 0) {
      throw InvalidInput(message("knot net: crease edge ", a, ", ", b, " is no edge of the mesh."));
    }
  }
}

template <>
void validate<3>(const KnotNet<3>& net) {
  check_clouds(net);
  for (std::size_t t = 0; t < net.mesh.simplices.size(); ++t) check_tetrahedron(net, t);
  check_border_faces(net);
}

}  // namespace crease

#include "Transforms/Domains/TetrahedronKnots.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "Core/Error.h"

namespace crease {
namespace {

using Tetrahedron = std::array<Point<3>, 4>;

double content(const Tetrahedron& p) { return (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]); }

double insphere_radius(const Tetrahedron& p) {
  double twice_surface = 0;
  for (int k = 0; k < 4; ++k) {
    const Point<3>&a = p[(k + 1) % 4], &b = p[(k + 2) % 4], &c = p[(k + 3) % 4];
    twice_surface += (b - a).cross(c - a).norm();
  }
  return content(p) / twice_surface;
}

Tetrahedron corners(const SimplexMesh<3>& mesh, std::size_t t) {
  const auto& s = mesh.simplices[t];
  return {mesh.vertices[s[0]], mesh.vertices[s[1]], mesh.vertices[s[2]], mesh.vertices[s[3]]};
}

/// Evenly spread directions: a spiral on the sphere.
Vector<3> spiral_direction(int k, int count) {
  const double z = 1 - (2 * k + 1.0) / count, angle = 2.39996 * k;
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// Generic directions, turned from vertex to vertex as in the plane.
std::vector<Vector<3>> generic_directions(const Vector<3>& place, int count) {
  const double first = 0.4 + 2 * std::numbers::pi * place.dot(Vector<3>(12.9898, 78.233, 37.719));
  const double second = 1.1 + 2 * std::numbers::pi * place.dot(Vector<3>(39.346, 11.135, 83.155));
  const Matrix<3> turn = (Eigen::AngleAxisd(first, Vector<3>::UnitZ()) *
                          Eigen::AngleAxisd(second, Vector<3>(0.6, 0.64, 0.48)))
                             .toRotationMatrix();
  std::vector<Vector<3>> result;
  for (int k = 0; k < count; ++k) result.push_back(turn * spiral_direction(k, count + 1));
  return result;
}

/// Directions well inside all half-spaces n.x > 0, far from each other; none if there is no room.
std::vector<Vector<3>> outer_directions(const std::vector<Vector<3>>& normals, int count) {
  constexpr int kCandidates = 400;
  constexpr double kMargin = 0.05;
  std::vector<Vector<3>> candidates;
  const auto depth = [&](const Vector<3>& d) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const auto& n : normals) smallest = std::min(smallest, n.dot(d));
    return smallest;
  };
  Vector<3> sum = Vector<3>::Zero();
  for (const auto& n : normals) sum += n;
  if (sum.norm() > 1e-9 && depth(sum.normalized()) > kMargin)
    candidates.push_back(sum.normalized());
  for (int k = 0; k < kCandidates; ++k) {
    const Vector<3> d = spiral_direction(k, kCandidates);
    if (depth(d) > kMargin) candidates.push_back(d);
  }
  if (candidates.empty()) return {};
  std::vector<Vector<3>> result;
  for (int k = 0; k < count; ++k) {
    const auto score = [&](const Vector<3>& d) {
      double smallest = 0.5 * depth(d);
      for (const auto& chosen : result) smallest = std::min(smallest, (chosen - d).norm());
      return smallest;
    };
    result.push_back(*std::max_element(
        candidates.begin(), candidates.end(),
        [&](const Vector<3>& a, const Vector<3>& b) { return score(a) < score(b); }));
  }
  return result;
}

const Point<3>& knot(const std::vector<Point<3>>& cloud, int index) {
  return cloud[static_cast<std::size_t>(index) < cloud.size() ? index : 0];
}

/// Calls visit(X_beta) for all |beta| <= degree.
template <typename Visit>
void for_each_knot_tetrahedron(const KnotNet<3>& net, std::size_t t, const Visit& visit) {
  const auto& s = net.mesh.simplices[t];
  const int n = net.degree;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      for (int k = 0; i + j + k <= n; ++k) {
        for (int l = 0; i + j + k + l <= n; ++l) {
          visit(Tetrahedron{knot(net.clouds[s[0]], i), knot(net.clouds[s[1]], j),
                            knot(net.clouds[s[2]], k), knot(net.clouds[s[3]], l)});
        }
      }
    }
  }
}

/// Looks for a point inside all knot tetrahedra: from the centroid, again and again across the face that it
/// violates most (relaxation, Agmon 1954).
bool has_common_interior(const KnotNet<3>& net, std::size_t t) {
  std::vector<std::pair<Vector<3>, double>> planes;  // n.x >= d, n of unit length
  for_each_knot_tetrahedron(net, t, [&](const Tetrahedron& p) {
    for (int k = 0; k < 4; ++k) {
      const Point<3>&a = p[(k + 1) % 4], &b = p[(k + 2) % 4], &c = p[(k + 3) % 4];
      Vector<3> normal = (b - a).cross(c - a).normalized();
      if (normal.dot(p[k] - a) < 0) normal = -normal;
      planes.emplace_back(normal, normal.dot(a));
    }
  });
  const auto whole = corners(net.mesh, t);
  const double margin = 1e-4 * insphere_radius(whole);
  Point<3> x = (whole[0] + whole[1] + whole[2] + whole[3]) / 4;
  for (int step = 0; step < 5000; ++step) {
    double worst = margin;
    const Vector<3>* normal = nullptr;
    for (const auto& [n, d] : planes) {
      if (n.dot(x) - d >= worst) continue;
      worst = n.dot(x) - d;
      normal = &n;
    }
    if (!normal) return true;
    x += 1.5 * (margin - worst) * *normal;
  }
  return false;
}

void check_options(const VolumeKnotOptions& options) {
  if (options.degree < 1 || options.degree > 5) {
    throw InvalidInput(message("place_knots: degree ", options.degree, " is not between 1 and 5."));
  }
  if (options.smoothness < -1 || options.smoothness > options.degree - 1) {
    throw InvalidInput(message("place_knots: smoothness ", options.smoothness,
                               " is not between 0 and degree - 1 = ", options.degree - 1, "."));
  }
  if (!(options.alpha > 0 && options.alpha < 1)) {
    throw InvalidInput(message("place_knots: alpha = ", options.alpha, " is not between 0 and 1."));
  }
}

}  // namespace

std::vector<BorderFace> border_faces(const SimplexMesh<3>& mesh) {
  std::map<std::array<int, 3>, std::pair<int, BorderFace>> faces;
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto& s = mesh.simplices[t];
    for (int k = 0; k < 4; ++k) {
      std::array<int, 3> face = {s[(k + 1) % 4], s[(k + 2) % 4], s[(k + 3) % 4]};
      std::sort(face.begin(), face.end());
      auto& [count, border] = faces[face];
      if (++count > 2) {
        throw InvalidInput(message("mesh: more than two tetrahedra share the face of vertices ",
                                   face[0], ", ", face[1], ", ", face[2], "."));
      }
      const Point<3>& a = mesh.vertices[face[0]];
      const Vector<3> normal =
          (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a).normalized();
      border = {face, normal.dot(mesh.vertices[s[k]] - a) > 0 ? Vector<3>(-normal) : normal};
    }
  }
  std::vector<BorderFace> result;
  for (const auto& [key, face] : faces) {
    if (face.first == 1) result.push_back(face.second);
  }
  return result;
}

KnotNet<3> place_knots(const SimplexMesh<3>& mesh, const VolumeKnotOptions& options) {
  check_options(options);
  KnotNet<3> net;
  net.degree = options.degree;
  net.mesh = mesh;
  std::vector<double> radius(mesh.vertices.size(), std::numeric_limits<double>::infinity());
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const double r = insphere_radius(corners(mesh, t));
    if (!(r > 0))
      throw InvalidInput(message("place_knots: tetrahedron ", t, " is folded or flat."));
    for (int v : mesh.simplices[t]) radius[v] = std::min(radius[v], options.alpha * r);
  }
  std::vector<std::vector<Vector<3>>> normals(mesh.vertices.size());
  for (const auto& face : border_faces(mesh)) {
    for (int v : face.vertices) normals[v].push_back(face.outwards);
  }
  Point<3> lower = mesh.vertices[0], upper = lower;
  for (const auto& p : mesh.vertices) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  const int distinct = options.smoothness < 0 ? options.degree - 1 : options.smoothness;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vector<3> place = (mesh.vertices[v] - lower).cwiseQuotient(upper - lower);
    const auto directions = normals[v].empty() ? generic_directions(place, distinct)
                                               : outer_directions(normals[v], distinct);
    auto& cloud = net.clouds.emplace_back(1, mesh.vertices[v]);
    for (int k = 1; k < options.degree; ++k) {
      const int used = std::min(k, static_cast<int>(directions.size())) - 1;
      cloud.push_back(used < 0 ? mesh.vertices[v]
                               : Point<3>(mesh.vertices[v] + radius[v] * directions[used]));
    }
  }
  return net;
}

void check_tetrahedron(const KnotNet<3>& net, std::size_t t) {
  const auto& s = net.mesh.simplices[t];
  for (int v : s) {
    if (v < 0 || v >= static_cast<int>(net.mesh.vertices.size())) {
      throw InvalidInput(
          message("knot net: tetrahedron ", t, " names vertex ", v, ", which is not there."));
    }
  }
  const auto whole = corners(net.mesh, t);
  const double scale =
      (whole[1] - whole[0]).norm() + (whole[2] - whole[0]).norm() + (whole[3] - whole[0]).norm();
  if (!(content(whole) > 1e-12 * scale * scale * scale)) {
    throw InvalidInput(message("knot net: tetrahedron ", t, " is folded or flat."));
  }
  double smallest = content(whole);
  for_each_knot_tetrahedron(
      net, t, [&](const Tetrahedron& p) { smallest = std::min(smallest, content(p)); });
  if (!(smallest > 1e-12 * content(whole))) {
    throw InvalidInput(message("knot net: knots of tetrahedron ", t, " span a tetrahedron of ",
                               smallest / content(whole),
                               " times its volume; make its clouds smaller."));
  }
  if (!has_common_interior(net, t)) {
    throw InvalidInput(message("knot net: the tetrahedra spanned by the knots of tetrahedron ", t,
                               " have no common interior; make its clouds smaller."));
  }
}

void check_border_faces(const KnotNet<3>& net) {
  for (const auto& face : border_faces(net.mesh)) {
    const Point<3>& origin = net.mesh.vertices[face.vertices[0]];
    const double scale = (net.mesh.vertices[face.vertices[1]] - origin).norm();
    for (int v : face.vertices) {
      for (const auto& p : net.clouds[v]) {
        const double distance = face.outwards.dot(p - origin);
        if (distance >= -1e-9 * scale) continue;
        throw InvalidInput(message("knot net: a knot of border vertex ", v, " lies ", -distance,
                                   " mm inside the domain, seen from the face of vertices ",
                                   face.vertices[0], ", ", face.vertices[1], ", ", face.vertices[2],
                                   "; border knots must lie outside."));
      }
    }
  }
}

}  // namespace crease

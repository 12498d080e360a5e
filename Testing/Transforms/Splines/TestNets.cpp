#include "Testing/Transforms/Splines/TestNets.h"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "Transforms/Splines/BPatchIndices.h"
#include "Transforms/Splines/KnotLocator.h"

namespace crease::testing {
namespace {

constexpr double kGoldenAngle = 2.39996;
constexpr double kPi = std::numbers::pi;

Vector<2> unit(double angle) { return {std::cos(angle), std::sin(angle)}; }
double angle_of(const Vector<2>& d) { return std::atan2(d.y(), d.x()); }

// Smallest inradius (area / half perimeter) of the triangles at each vertex.
std::vector<double> inradii(const SimplexMesh<2>& mesh) {
  std::vector<double> radius(mesh.vertices.size(), std::numeric_limits<double>::infinity());
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto v = simplex_corners(mesh, static_cast<int>(t));
    const double perimeter = (v[1] - v[0]).norm() + (v[2] - v[1]).norm() + (v[0] - v[2]).norm();
    const double inradius = signed_content<2>(v) / perimeter;
    for (int i : mesh.simplices[t]) radius[i] = std::min(radius[i], inradius);
  }
  return radius;
}

// For border vertices the neighbours before and after along the counter-clockwise border.
std::map<int, std::pair<int, int>> border_neighbours(const SimplexMesh<2>& mesh) {
  std::map<std::pair<int, int>, bool> directed;
  for (const auto& t : mesh.simplices) {
    for (int k = 0; k < 3; ++k) directed[{t[k], t[(k + 1) % 3]}] = true;
  }
  std::map<int, std::pair<int, int>> result;
  for (const auto& [edge, present] : directed) {
    if (directed.count({edge.second, edge.first})) continue;
    result[edge.first].second = edge.second;
    result[edge.second].first = edge.first;
  }
  return result;
}

std::vector<Point<2>> border_cloud(const Point<2>& v, const Point<2>& before, const Point<2>& after,
                                   int degree, double r) {
  double interior = angle_of(before - v) - angle_of(after - v);
  if (interior <= 0.0) interior += 2 * kPi;
  const bool convex = interior <= kPi + 1e-9;
  const double lower = convex ? angle_of(v - after) : angle_of(before - v);
  const double width = convex ? interior : 2 * kPi - interior;
  std::vector<Point<2>> cloud = {v};
  for (int k = 1; k < degree; ++k) {
    const double shift = k % 2 == 1 ? 0.2 : -0.2;
    cloud.emplace_back(v + r * unit(lower + width * (k - 0.5 + shift) / degree));
  }
  return cloud;
}

void set_crease_cloud(KnotNet<2>& net, int vertex, const Vector<2>& first,
                      const Vector<2>& second) {
  auto& cloud = net.clouds[vertex];
  for (int k = 1; k < net.degree; ++k) {
    const double share = std::pow(0.5, (k - 1) / 2);
    cloud[k] = cloud[0] + share * (k % 2 == 1 ? first : second);
  }
}

}  // namespace

SimplexMesh<2> grid_mesh(int cells_x, int cells_y) {
  SimplexMesh<2> mesh;
  for (int j = 0; j <= cells_y; ++j) {
    for (int i = 0; i <= cells_x; ++i) mesh.vertices.emplace_back(10.0 * i, 10.0 * j);
  }
  const auto id = [&](int i, int j) { return j * (cells_x + 1) + i; };
  for (int j = 0; j < cells_y; ++j) {
    for (int i = 0; i < cells_x; ++i) {
      mesh.simplices.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      mesh.simplices.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  return mesh;
}

SimplexMesh<2> jittered_mesh(int cells_x, int cells_y, int seed) {
  SimplexMesh<2> mesh = grid_mesh(cells_x, cells_y);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-2.0, 2.0);
  for (auto& v : mesh.vertices) {
    const Vector<2> d(shift(random), shift(random));
    const bool inner = v.x() > 0 && v.x() < 10 * cells_x && v.y() > 0 && v.y() < 10 * cells_y;
    if (inner) v += d;
  }
  return mesh;
}

KnotNet<2> spread_knots(SimplexMesh<2> mesh, int degree, double alpha, bool same_pattern) {
  KnotNet<2> net;
  net.degree = degree;
  const auto radius = inradii(mesh);
  const auto border = border_neighbours(mesh);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Point<2>& v = mesh.vertices[i];
    const double r = alpha * radius[i];
    if (const auto found = border.find(static_cast<int>(i)); found != border.end()) {
      net.clouds.push_back(border_cloud(v, mesh.vertices[found->second.first],
                                        mesh.vertices[found->second.second], degree, r));
      continue;
    }
    const double start = 0.4 + (same_pattern ? 0.0 : 1.7 * static_cast<double>(i));
    std::vector<Point<2>> cloud = {v};
    for (int k = 1; k < degree; ++k) cloud.emplace_back(v + r * unit(start + kGoldenAngle * k));
    net.clouds.push_back(cloud);
  }
  net.mesh = std::move(mesh);
  return net;
}

KnotNet<2> jittered_net(int cells_x, int cells_y, int degree, double alpha, int seed) {
  return spread_knots(jittered_mesh(cells_x, cells_y, seed), degree, alpha);
}

KnotNet<2> within_eight(KnotNet<2> net) {
  double largest = 8.0;
  for (const auto& v : net.mesh.vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  for (auto& v : net.mesh.vertices) v *= 8.0 / largest;
  for (auto& cloud : net.clouds) {
    for (auto& knot : cloud) knot *= 8.0 / largest;
  }
  return net;
}

KnotNet<2> collapsed_knots(SimplexMesh<2> mesh, int degree) {
  KnotNet<2> net;
  net.degree = degree;
  for (const auto& v : mesh.vertices) net.clouds.emplace_back(std::max(1, degree), v);
  net.mesh = std::move(mesh);
  return net;
}

KnotNet<2> straight_crease_net(int degree, double alpha) {
  SimplexMesh<2> mesh = jittered_mesh(4, 4, 3);
  for (int j = 0; j <= 4; ++j) mesh.vertices[5 * j + 2] = {20.0, 10.0 * j};
  const auto radius = inradii(mesh);
  KnotNet<2> net = spread_knots(std::move(mesh), degree, alpha);
  for (int j = 0; j <= 4; ++j) {
    const int v = 5 * j + 2;
    const Vector<2> up(0.0, alpha * radius[v]);
    if (j > 0 && j < 4) {
      set_crease_cloud(net, v, up, -up);
    } else {
      const Vector<2> out = j == 0 ? Vector<2>(-up) : up;
      for (int k = 1; k < degree; ++k)
        net.clouds[v][k] = net.clouds[v][0] + (1 - (k - 1) / 4.0) * out;
    }
    if (j > 0) net.crease_edges.push_back({{v - 5, v}, false});
  }
  return net;
}

KnotNet<2> ring_net(int degree, double alpha, bool body) {
  constexpr int kSides = 12, kRings = 4, kLine = 1;  // ring 1 of 0..3 carries the crease
  SimplexMesh<2> mesh;
  mesh.vertices.emplace_back(0.0, 0.0);
  const auto id = [](int ring, int k) { return 1 + kSides * ring + (k + kSides) % kSides; };
  for (int ring = 0; ring < kRings; ++ring) {
    for (int k = 0; k < kSides; ++k) {
      const Vector<2> d = unit((k + 0.5) * 2 * kPi / kSides);
      const double radius =
          ring < 3 ? 0.5 + 0.5 * ring + (ring == 2 ? 0.1 : 0.0) : 2.2 / d.cwiseAbs().maxCoeff();
      mesh.vertices.emplace_back(radius * d);
    }
  }
  for (int k = 0; k < kSides; ++k) {
    mesh.simplices.push_back({0, id(0, k), id(0, k + 1)});
    for (int ring = 0; ring + 1 < kRings; ++ring) {
      mesh.simplices.push_back({id(ring, k), id(ring + 1, k), id(ring + 1, k + 1)});
      mesh.simplices.push_back({id(ring, k), id(ring + 1, k + 1), id(ring, k + 1)});
    }
  }
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    mesh.regions.push_back(simplex_centroid(mesh, static_cast<int>(t)).norm() < 1.0 ? 1 : 0);
  }

  KnotNet<2> net = spread_knots(std::move(mesh), degree, alpha);
  const auto& vertices = net.mesh.vertices;
  for (int k = 0; k < kSides; ++k) {
    const int v = id(kLine, k), before = id(kLine, k - 1), after = id(kLine, k + 1);
    const Vector<2> into = (vertices[v] - vertices[before]).normalized();
    const Vector<2> out = (vertices[after] - vertices[v]).normalized();
    const double edge = (vertices[after] - vertices[v]).norm();
    if (body) {
      set_crease_cloud(net, v, 0.25 * edge * into, -0.25 * edge * out);
    } else {
      const Vector<2> tangent = (into + out).normalized();
      set_crease_cloud(net, v, 0.35 * edge * tangent, -0.35 * edge * tangent);
    }
    net.crease_edges.push_back({{v, after}, body});
  }
  return net;
}

std::vector<KnotNet<2>> nets_of_all_degrees() {
  std::vector<KnotNet<2>> all;
  for (int degree = 1; degree <= 5; ++degree) {
    all.push_back(jittered_net(4, 4, degree, 0.4, degree));
    all.push_back(straight_crease_net(degree, 0.4));
  }
  all.push_back(collapsed_knots(jittered_mesh(4, 4, 1), 3));
  return all;
}

KnotNet<3> tetrahedral_net(int degree, double alpha) {
  KnotNet<3> net;
  net.degree = degree;
  for (int c = 0; c < 8; ++c) {
    net.mesh.vertices.emplace_back(10.0 * (c & 1), 10.0 * (c >> 1 & 1), 10.0 * (c >> 2 & 1));
  }
  net.mesh.vertices.emplace_back(5.3, 4.8, 5.1);
  const int faces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : faces) {
    for (std::array<int, 4> t :
         {std::array{f[0], f[1], f[2], 8}, std::array{f[0], f[2], f[3], 8}}) {
      net.mesh.simplices.push_back(t);
      if (signed_content<3>(
              simplex_corners(net.mesh, static_cast<int>(net.mesh.simplices.size()) - 1)) < 0) {
        std::swap(net.mesh.simplices.back()[0], net.mesh.simplices.back()[1]);
      }
    }
  }
  const double r = alpha * 1.2;  // the smallest insphere of these tetrahedra has radius 1.3
  for (std::size_t i = 0; i < net.mesh.vertices.size(); ++i) {
    const Point<3>& v = net.mesh.vertices[i];
    std::vector<Point<3>> cloud = {v};
    for (int k = 1; k < degree; ++k) {
      Vector<3> d(1.0 + 0.3 * k, 1.4 - 0.35 * k + 0.07 * static_cast<double>(i), 0.6 + 0.25 * k);
      if (i < 8)
        d = d.cwiseProduct(
            Vector<3>((v.array() > 5).select(Vector<3>::Ones(), -Vector<3>::Ones())));
      cloud.emplace_back(v + r * (k % 2 == 0 && i == 8 ? -1.0 : 1.0) * d.normalized());
    }
    net.clouds.push_back(cloud);
  }
  return net;
}

template <int Dim>
std::vector<Point<Dim>> points_inside(const SimplexMesh<Dim>& mesh, int per_simplex, int seed) {
  std::mt19937 random(seed);
  std::exponential_distribution<double> share;
  std::vector<Point<Dim>> points;
  for (std::size_t s = 0; s < mesh.simplices.size(); ++s) {
    for (int i = 0; i < per_simplex; ++i) {
      Point<Dim> p = Point<Dim>::Zero();
      double sum = 0.0;
      for (const auto& corner : simplex_corners(mesh, static_cast<int>(s))) {
        const double w = share(random);
        p += w * corner;
        sum += w;
      }
      points.push_back(p / sum);
    }
  }
  return points;
}

std::vector<Point<2>> special_points(const KnotNet<2>& net) {
  const KnotLocator<2> locator(net.mesh, kKnotTie * mesh_scale(net.mesh));
  std::vector<Point<2>> points = net.mesh.vertices;
  for (std::size_t t = 0; t < net.mesh.simplices.size(); ++t) {
    const auto v = simplex_corners(net.mesh, static_cast<int>(t));
    points.push_back(simplex_centroid(net.mesh, static_cast<int>(t)));
    for (int k = 0; k < 3; ++k) {
      for (double s : {0.03, 0.5, 0.7}) points.emplace_back((1 - s) * v[k] + s * v[(k + 1) % 3]);
    }
  }
  for (const auto& cloud : net.clouds) {
    for (const auto& knot : cloud) {
      if (locator.find(knot) >= 0) points.push_back(knot);
    }
  }
  return points;
}

template <int Dim>
SplineJet<Dim> local_function(const KnotNet<Dim>& net, int simplex, int index, const Point<Dim>& u,
                              std::span<const Vector<Dim>> flag) {
  const auto beta = multi_indices<Dim>(net.degree)[index];
  std::vector<Point<Dim>> knots;
  std::array<Point<Dim>, Dim + 1> corners;
  for (int j = 0; j <= Dim; ++j) {
    const auto& cloud = net.clouds[net.mesh.simplices[simplex][j]];
    const auto knot = [&](int k) { return cloud[k == net.degree ? 0 : k]; };
    for (int k = 0; k <= beta[j]; ++k) knots.push_back(knot(k));
    corners[j] = knot(beta[j]);
  }
  SplineJet<Dim> jet = simplex_spline<Dim>(knots, u, flag);
  const double factor = std::abs(signed_content<Dim>(corners));
  jet.value *= factor;
  jet.gradient *= factor;
  jet.hessian *= factor;
  return jet;
}

template std::vector<Point<2>> points_inside<2>(const SimplexMesh<2>&, int, int);
template std::vector<Point<3>> points_inside<3>(const SimplexMesh<3>&, int, int);
template SplineJet<2> local_function<2>(const KnotNet<2>&, int, int, const Point<2>&,
                                        std::span<const Vector<2>>);
template SplineJet<3> local_function<3>(const KnotNet<3>&, int, int, const Point<3>&,
                                        std::span<const Vector<3>>);

}  // namespace crease::testing

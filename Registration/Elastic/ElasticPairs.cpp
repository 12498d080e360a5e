#include "Registration/Elastic/ElasticPairs.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "Core/Error.h"
#include "Registration/Elastic/PairText.h"
#include "Registration/Elastic/SnapWarnings.h"
#include "Transforms/Domains/ArcLength.h"
#include "Transforms/Domains/MeshTopology.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

/// The border of a mesh as closed polygons, the domain on the left.
std::vector<Polyline> border_rings(const SimplexMesh<2>& mesh) {
  const MeshTopology topology(mesh);
  std::vector<int> next(mesh.vertices.size(), -1);
  for (const auto& edge : topology.edges()) {
    if (edge.triangles[1] >= 0) continue;
    const auto& s = mesh.simplices[edge.triangles[0]];
    for (int k = 0; k < 3; ++k) {
      const int a = s[k], b = s[(k + 1) % 3];
      if (std::minmax(a, b) == std::minmax(edge.vertices[0], edge.vertices[1])) next[a] = b;
    }
  }
  std::vector<Polyline> rings;
  for (std::size_t first = 0; first < next.size(); ++first) {
    Polyline ring;
    for (int v = static_cast<int>(first); next[v] >= 0;) {
      ring.push_back(mesh.vertices[v]);
      v = std::exchange(next[v], -1);
    }
    if (ring.size() >= 3) rings.push_back(std::move(ring));
  }
  return rings;
}

/// Whether the segments a b and c d cross in inner points of both.
bool cross_each_other(const Point<2>& a, const Point<2>& b, const Point<2>& c, const Point<2>& d) {
  const double of_c = cross(b - a, c - a), of_d = cross(b - a, d - a);
  const double of_a = cross(d - c, a - c), of_b = cross(d - c, b - c);
  return of_c * of_d < 0 && of_a * of_b < 0;
}

/// Numbers from 1, as in files.
std::string segment_text(const std::vector<int>& contour, std::size_t k) {
  return message(contour[k] + 1, " to ", contour[k + 1] + 1);
}

void check_row(const std::vector<Point<2>>& points, const std::vector<int>& contour,
               const char* where) {
  for (std::size_t k = 0; k + 1 < contour.size(); ++k) {
    for (std::size_t l = k + 2; l + 1 < contour.size(); ++l) {
      if (!cross_each_other(points[contour[k]], points[contour[k + 1]], points[contour[l]],
                            points[contour[l + 1]])) {
        continue;
      }
      throw InvalidInput(
          message("contour pairs cross in the ", where, " image: the line from pair ",
                  segment_text(contour, k), " meets that from pair ", segment_text(contour, l),
                  "; the map between them would fold. Correct or delete one of them."));
    }
  }
}

/// Angle from the direction a b to the direction b c.
double turn_at(const std::vector<Point<2>>& points, int a, int b, int c) {
  return turn_angle(points[b] - points[a], points[c] - points[b]);
}

/// The part of every control point: those of one part are joined by couplings.
std::vector<int> connected_parts(const SplineBasis<2>& basis) {
  std::vector<int> parent(basis.num_control_points());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& [i, k] : basis.couplings()) {
    const int a = root(i), b = root(k);
    parent[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = root(static_cast<int>(i));
  return parent;
}

}  // namespace

std::vector<std::string> snap_to_domain(Landmarks<2>& pairs, const SplineBasis<2>& basis,
                                        double snap_mm) {
  SnapWarnings warnings("fixed points", "the domain");
  for (std::size_t j = 0; j < pairs.fixed.size(); ++j) {
    Point<2>& p = pairs.fixed[j];
    if (basis.contains(p)) continue;
    const Point<2> nearest = basis.nearest_point(p);
    const double distance = (nearest - p).norm();
    const std::string point = message("pair ", j + 1, ": the fixed point ", place_text(p));
    if (!(distance <= snap_mm)) {
      throw InvalidInput(
          message(point, " lies ", distance, " mm outside the domain; move or delete it."));
    }
    warnings.add(point, distance);
    p = nearest;
  }
  return warnings.list();
}

std::vector<std::vector<int>> pairs_along_border(const Landmarks<2>& pairs,
                                                 const SplineBasis<2>& basis, double near_mm) {
  const auto* triangular = dynamic_cast<const TriangularBSplineBasis<2>*>(&basis);
  if (triangular == nullptr) return {};
  struct Place {
    double arc;
    int pair;
  };
  std::vector<std::vector<int>> rows;
  for (const auto& ring : border_rings(triangular->net().mesh)) {
    std::vector<Place> places;
    for (std::size_t j = 0; j < pairs.fixed.size(); ++j) {
      const NearestPlace nearest = nearest_place(ring, true, pairs.fixed[j]);
      if (nearest.distance <= near_mm) places.push_back({nearest.length, static_cast<int>(j)});
    }
    if (places.size() < 2) continue;
    std::ranges::sort(places, {}, &Place::arc);
    std::size_t begin = 0;
    double widest = places.front().arc + polyline_length(ring, true) - places.back().arc;
    for (std::size_t k = 1; k < places.size(); ++k) {
      const double gap = places[k].arc - places[k - 1].arc;
      if (gap > widest) begin = k, widest = gap;
    }
    std::rotate(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(begin), places.end());
    std::vector<int>& row = rows.emplace_back();
    for (const Place& place : places) row.push_back(place.pair);
  }
  return rows;
}

void check_no_crossing(const Landmarks<2>& pairs, const std::vector<int>& contour) {
  constexpr double kMostTurn = 120 * std::numbers::pi / 180;  // that the map may add at a pair
  for (int j : contour) {
    if (j >= 0 && j < pairs.size()) continue;
    throw InvalidInput(
        message("contour: there is no pair ", j + 1, " among the ", pairs.size(), " pairs."));
  }
  check_row(pairs.fixed, contour, "fixed");
  check_row(pairs.moving, contour, "moving");
  for (std::size_t k = 1; k + 1 < contour.size(); ++k) {
    const int a = contour[k - 1], b = contour[k], c = contour[k + 1];
    const double turn = turn_at(pairs.moving, a, b, c) - turn_at(pairs.fixed, a, b, c);
    if (std::abs(std::remainder(turn, 2 * std::numbers::pi)) <= kMostTurn) continue;
    throw InvalidInput(message("contour pairs ", a + 1, ", ", b + 1, " and ", c + 1,
                               " turn back in the moving image: two of them may be exchanged. The "
                               "map between them would fold; correct or delete one of them."));
  }
}

void check_no_floating_part(const Landmarks<2>& pairs, const std::vector<int>& independent,
                            const SplineBasis<2>& basis) {
  const std::vector<int> part = connected_parts(basis);
  std::vector<int> held(part.size(), 0);
  for (int j : independent) ++held[part[basis.evaluate(pairs.fixed[j]).control_points.front()]];
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (part[i] != static_cast<int>(i) || held[i] >= 2) continue;
    throw InvalidInput(message("the part of the domain around ",
                               place_text(basis.greville_points().col(i)), " holds ",
                               held[i] == 0 ? "no pair" : "one pair only",
                               ": it can still float. Every connected part needs two independent "
                               "pairs."));
  }
}

}  // namespace crease

#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "Core/Box.h"
#include "Core/Raster.h"
#include "Transforms/Domains/DomainMesh.h"
#include "Transforms/Domains/RegionOfInterest.h"
#include "Transforms/Domains/StructuredTriangulation.h"

namespace crease::testing {

inline Box<2> box(double x0, double y0, double x1, double y1) {
  Box<2> result;
  result.add({x0, y0});
  result.add({x1, y1});
  return result;
}

inline RegionOfInterest rectangle(double x0, double y0, double x1, double y1) {
  return RegionOfInterest({{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}});
}

/// A regular polygon, counter-clockwise, its first corner at angle 0.1.
inline Polyline regular_polygon(const Point<2>& centre, double radius, int corners) {
  Polyline points;
  for (int k = 0; k < corners; ++k) {
    const double angle = 0.1 + 2 * std::numbers::pi * k / corners;
    points.push_back(centre + radius * Vector<2>(std::cos(angle), std::sin(angle)));
  }
  return points;
}

inline FeatureLine open_line(Polyline points, BodySide body = BodySide::kNone) {
  FeatureLine line;
  line.points = std::move(points);
  line.body = body;
  return line;
}

inline FeatureLine closed_line(Polyline points, BodySide body = BodySide::kAutomatic) {
  FeatureLine line;
  line.points = std::move(points);
  line.closed = true;
  line.body = body;
  return line;
}

/// Signed distance to a rectangle with rounded corners, turned by `angle`; negative inside.
struct RoundedRectangle {
  Point<2> centre;
  double angle = 0, half_width = 0, half_height = 0, corner = 0;

  double distance(const Point<2>& p) const {
    const Vector<2> d = p - centre;
    const double x = std::cos(angle) * d.x() + std::sin(angle) * d.y();
    const double y = -std::sin(angle) * d.x() + std::cos(angle) * d.y();
    const double qx = std::abs(x) - half_width + corner, qy = std::abs(y) - half_height + corner;
    return std::hypot(std::max(qx, 0.0), std::max(qy, 0.0)) + std::min(std::max(qx, qy), 0.0) -
           corner;
  }
  double area() const {
    return 4 * half_width * half_height - (4 - std::numbers::pi) * corner * corner;
  }
};

/// Five vertebra-like bodies on a 512 x 512 image of 1 mm pixels.
inline std::vector<RoundedRectangle> spine_bodies() {
  std::vector<RoundedRectangle> bodies;
  for (int i = 0; i < 5; ++i) {
    bodies.push_back({{256 + 30 * std::sin(0.6 * i), 60.0 + 95 * i},
                      -std::atan2(18 * std::cos(0.6 * i), 95),
                      35,
                      21,
                      8});
  }
  return bodies;
}

template <typename Shape>
std::vector<std::int32_t> label_image(const Raster<2>& raster, const std::vector<Shape>& bodies) {
  std::vector<std::int32_t> labels(static_cast<std::size_t>(raster.num_samples()), 0);
  for (int j = 0; j < raster.size[1]; ++j) {
    for (int i = 0; i < raster.size[0]; ++i) {
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (bodies[b].distance(raster.point(Vector<2>(i, j))) <= 0) {
          labels[static_cast<std::size_t>(j) * raster.size[0] + i] = static_cast<int>(b) + 1;
        }
      }
    }
  }
  return labels;
}

inline Raster<2> square_raster(int size) {
  Raster<2> raster;
  raster.size = {size, size};
  return raster;
}

/// Area of the triangles of one region.
inline double region_area(const SimplexMesh<2>& mesh, int region) {
  double area = 0;
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto& s = mesh.simplices[t];
    if (mesh.region(static_cast<int>(t)) != region) continue;
    area += 0.5 * cross(mesh.vertices[s[1]] - mesh.vertices[s[0]],
                        mesh.vertices[s[2]] - mesh.vertices[s[0]]);
  }
  return area;
}

/// A line across [0,4] x [0,2] along the middle of a structured mesh, its middle vertex raised.
inline DomainMesh bent_line(double height, BodySide body = BodySide::kNone) {
  SimplexMesh<2> mesh = structured_triangulation(box(0, 0, 4, 2), 4, 2, Diagonals::kRising);
  mesh.vertices[7] = Point<2>(2, 1 + height);
  return attach_feature_lines(mesh,
                              {open_line({{0, 1}, {1, 1}, {2, 1 + height}, {3, 1}, {4, 1}}, body)});
}

/// [0, cells]^2 in unit cells, with lines along its edges.
inline DomainMesh square(int cells, const std::vector<FeatureLine>& lines,
                         Diagonals diagonals = Diagonals::kUnionJack) {
  const double side = cells;
  return attach_feature_lines(
      structured_triangulation(box(0, 0, side, side), cells, cells, diagonals), lines);
}

/// Inradius of its triangles, right-angled with legs 1.
inline const double kUnitInradius = 1 / (2 + std::sqrt(2.0));

inline int vertex_at(const SimplexMesh<2>& mesh, const Point<2>& p) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if ((mesh.vertices[v] - p).norm() < 1e-9) return static_cast<int>(v);
  }
  return -1;
}

}  // namespace crease::testing

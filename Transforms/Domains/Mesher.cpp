#include "Transforms/Domains/Mesher.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <queue>

#include "Core/Error.h"
#include "Transforms/Domains/CurveSampling.h"
#include "Transforms/Domains/DelaunayRefinement.h"
#include "Transforms/Domains/LineArrangement.h"
#include "Transforms/Domains/MeshTopology.h"
#include "Transforms/Domains/SizeField.h"

namespace crease {
namespace {

constexpr double kTrianglesPerSquare = 2.3;  // about 4 / sqrt(3): triangles in a square of one edge
constexpr double kLargestEdge = 1.45;        // over the mean edge: measured on meshes of one size

/// All lengths of the options filled in.
MeshOptions completed(const RegionOfInterest& region, MeshOptions options) {
  const auto check = [](double value, const char* name) {
    if (!(value >= 0) || !std::isfinite(value)) {
      throw InvalidInput(message("mesh: ", name, " = ", value,
                                 " must be positive, or 0 for its "
                                 "default."));
    }
  };
  check(options.edge_length, "edge_length");
  check(options.edge_length_near_lines, "edge_length_near_lines");
  check(options.edge_length_in_bodies, "edge_length_in_bodies");
  check(options.line_tolerance, "line_tolerance");
  if (options.num_triangles < 0 || options.num_triangles > kMostTriangles) {
    throw InvalidInput(message("mesh: num_triangles = ", options.num_triangles,
                               " must be between 1 and ", kMostTriangles, ", or 0."));
  }
  for (const FineDisc& disc : options.fine_discs) {
    if (disc.centre.allFinite() && disc.radius >= 0 && disc.edge_length > 0) continue;
    throw InvalidInput(message("mesh: a disc of radius ", disc.radius, " mm with edges of ",
                               disc.edge_length, " mm; both must be positive."));
  }
  if (!(options.gradation > 0)) {
    throw InvalidInput(message("mesh: gradation = ", options.gradation, " must be positive."));
  }
  if (options.edge_length == 0) options.edge_length = region.bounds().size().maxCoeff() / 12;
  if (options.edge_length_near_lines == 0) options.edge_length_near_lines = options.edge_length / 2;
  if (options.edge_length_in_bodies == 0) options.edge_length_in_bodies = options.edge_length;
  return options;
}

MeshOptions scaled(MeshOptions options, double factor) {
  options.edge_length *= factor;
  options.edge_length_near_lines *= factor;
  options.edge_length_in_bodies *= factor;
  return options;
}

/// The edge length that the discs ask for at p; infinite without any.
double length_for_discs(const MeshOptions& options, const Point<2>& p) {
  double length = std::numeric_limits<double>::infinity();
  for (const FineDisc& disc : options.fine_discs) {
    const double outside = std::max(0.0, (p - disc.centre).norm() - disc.radius);
    length = std::min(length, disc.edge_length + options.gradation * outside);
  }
  return length;
}

[[noreturn]] void refuse(double estimate, const MeshOptions& options) {
  throw InvalidInput(message("mesh: an edge length of ", options.edge_length, " mm (",
                             options.edge_length_near_lines, " mm near lines) would give about ",
                             estimate, " triangles; at most ", kMostTriangles,
                             " are possible: choose longer edges."));
}

/// A point inside a simple polygon: in the ear at its lowest corner.
Point<2> point_inside(const Polyline& polygon) {
  const int n = static_cast<int>(polygon.size());
  const int v =
      static_cast<int>(std::min_element(polygon.begin(), polygon.end(),
                                        [](const Point<2>& p, const Point<2>& q) {
                                          return p.y() < q.y() || (p.y() == q.y() && p.x() < q.x());
                                        }) -
                       polygon.begin());
  const Point<2>&a = polygon[(v + n - 1) % n], &b = polygon[(v + 1) % n];
  Polyline ear{a, polygon[v], b};
  if (signed_area(ear) < 0) std::reverse(ear.begin(), ear.end());
  double farthest = 0;
  Point<2> result = (ear[0] + ear[1] + ear[2]) / 3;
  for (const auto& p : polygon) {
    if (p == a || p == b || p == polygon[v] || !point_in_polygon(ear, p)) continue;
    const double distance = std::abs(cross(b - a, p - a));
    if (distance <= farthest) continue;
    farthest = distance;
    result = 0.5 * (polygon[v] + p);
  }
  return result;
}

/// Points at the tips of even triangles on both sides of all edges. With them the mesher seldom has to
/// divide an edge. Points that would be near to each other or to an edge are left out.
std::vector<Point<2>> tips_beside_edges(const LineArrangement& arrangement) {
  constexpr double kHeight = 0.85;    // over the edge's length
  constexpr double kDistance = 0.65;  // from edges and other tips, over the edge's length
  std::vector<Point<2>> tips, lower, upper;
  std::vector<double> reach;
  auto edges = arrangement.edges;
  const auto length = [&](const LineArrangement::Edge& edge) {
    return (arrangement.vertices[edge.b] - arrangement.vertices[edge.a]).norm();
  };
  std::stable_sort(edges.begin(), edges.end(),
                   [&](const auto& e, const auto& f) { return length(e) < length(f); });
  for (const auto& edge : edges) {
    const Point<2>&a = arrangement.vertices[edge.a], &b = arrangement.vertices[edge.b];
    for (double side : {1.0, -1.0}) {
      if (edge.line < 0 && side < 0) continue;  // the domain is on the left of its border
      const Point<2> tip = 0.5 * (a + b) + side * kHeight * turned_left(b - a);
      tips.push_back(tip);
      reach.push_back(kDistance * (b - a).norm());
    }
  }
  const std::size_t num_tips = tips.size();
  for (std::size_t i = 0; i < num_tips; ++i) {
    lower.emplace_back(tips[i] - Vector<2>::Constant(reach[i]));
    upper.emplace_back(tips[i] + Vector<2>::Constant(reach[i]));
  }
  for (const auto& edge : arrangement.edges) {
    const Point<2>&a = arrangement.vertices[edge.a], &b = arrangement.vertices[edge.b];
    lower.emplace_back(a.cwiseMin(b));
    upper.emplace_back(a.cwiseMax(b));
  }
  std::vector<char> keep(num_tips, 1);
  for (const auto& [i, k] : intersecting_boxes(lower, upper)) {
    const auto tip = static_cast<std::size_t>(i), other = static_cast<std::size_t>(k);
    if (tip >= num_tips || !keep[tip]) continue;
    if (other < num_tips) {
      if (keep[other] && (tips[tip] - tips[other]).norm() < std::min(reach[tip], reach[other])) {
        keep[other] = 0;
      }
    } else {
      const auto& edge = arrangement.edges[other - num_tips];
      const Point<2> q = closest_point_on_segment(tips[tip], arrangement.vertices[edge.a],
                                                  arrangement.vertices[edge.b]);
      if ((q - tips[tip]).norm() < reach[tip]) keep[tip] = 0;
    }
  }
  std::vector<Point<2>> result;
  for (std::size_t i = 0; i < num_tips; ++i) {
    if (keep[i]) result.push_back(tips[i]);
  }
  return result;
}

/// The mesher bounds angles from below by 20.7 degrees, except where border and lines meet more sharply.
void report_small_angles(DomainMesh& domain) {
  constexpr double kSmallest = 20;
  double smallest = kSmallest;
  int count = 0;
  Point<2> place = Point<2>::Zero();
  for (const auto& s : domain.mesh.simplices) {
    const auto angles = corner_angles_deg(domain.mesh, s);
    const auto least = std::min_element(angles.begin(), angles.end());
    if (*least >= kSmallest) continue;
    ++count;
    if (*least >= smallest) continue;
    smallest = *least;
    place = domain.mesh.vertices[s[least - angles.begin()]];
  }
  if (count == 0) return;
  domain.notes.push_back(message(count, " triangles have an angle below 20 degrees, the smallest ",
                                 smallest, " at (", place.x(), ", ", place.y(),
                                 ") mm: lines or border meet sharply there."));
}

/// Meshes one region with its lines again and again for different lengths.
class DomainMesher {
 public:
  DomainMesher(const RegionOfInterest& region, const std::vector<FeatureLine>& lines)
      : region_(region), lines_(lines), bodies_(with_body_labels(lines)) {}

  DomainMesh mesh(const MeshOptions& options) const;

 private:
  using Lengths = std::function<double(const Point<2>&)>;

  Lengths wanted_lengths(const MeshOptions& options,
                         std::vector<SizeField::Segment> segments) const;
  void check_size(const Lengths& lengths, const MeshOptions& options) const;
  void set_chains(const LineArrangement& arrangement, const std::vector<FeatureLine>& prepared,
                  const std::vector<std::vector<int>>& paths, DomainMesh& domain) const;
  void set_regions(DomainMesh& domain) const;

  const RegionOfInterest& region_;
  const std::vector<FeatureLine>& lines_;
  BodyRegions bodies_;
};

/// The edge length wanted at a point: of lines, regions and discs the shortest. The options must stay
/// alive.
DomainMesher::Lengths DomainMesher::wanted_lengths(const MeshOptions& options,
                                                   std::vector<SizeField::Segment> segments) const {
  const bool same = options.edge_length_in_bodies == options.edge_length;
  const auto base = [&](const Point<2>& p) {
    return !same && bodies_.label_at(p) > 0 ? options.edge_length_in_bodies : options.edge_length;
  };
  const SizeField field(region_.bounds(), base, std::move(segments), options.gradation);
  return [field, &options](const Point<2>& p) {
    return std::min(field(p), length_for_discs(options, p));
  };
}

/// Integrates the number of triangles over the region before they are made.
void DomainMesher::check_size(const Lengths& lengths, const MeshOptions& options) const {
  constexpr int kSteps = 64;
  const Box<2> box = region_.bounds();
  const double cell = box.size().prod() / (kSteps * kSteps);
  double triangles = 0;
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      const Vector<2> part((i + 0.5) / kSteps, (j + 0.5) / kSteps);
      const Point<2> p = box.lower + box.size().cwiseProduct(part);
      if (region_.contains(p)) triangles += kTrianglesPerSquare * cell / std::pow(lengths(p), 2);
    }
  }
  if (triangles > kMostTriangles) refuse(triangles, options);
}

DomainMesh DomainMesher::mesh(const MeshOptions& options) const {
  // Before anything that grows with the number of triangles.
  double estimate = kTrianglesPerSquare * region_.area() / std::pow(options.edge_length, 2);
  for (const auto& line : lines_) {
    estimate += 4 * polyline_length(line.points, line.closed) / options.edge_length_near_lines;
  }
  if (estimate > 2.0 * kMostTriangles) refuse(estimate, options);

  DomainMesh domain;
  LineArrangementOptions arranging{.edge_length = options.edge_length_near_lines,
                                   .tolerance = options.line_tolerance > 0
                                                    ? options.line_tolerance
                                                    : options.edge_length_near_lines / 20,
                                   .resample = options.resample_lines,
                                   .border_length = nullptr};
  const auto prepared = prepared_lines(region_, lines_, arranging, domain.notes, domain.warnings);
  std::vector<SizeField::Segment> segments;
  for (const auto& line : prepared) {
    for (int e = 0; e < line.num_edges(); ++e) {
      const Point<2>&a = line.points[e], &b = line.points[(e + 1) % line.points.size()];
      segments.push_back({a, b, (b - a).norm()});
    }
  }
  arranging.border_length = wanted_lengths(options, segments);
  check_size(arranging.border_length, options);
  const LineArrangement arrangement = arrange(region_, prepared, arranging);
  domain.notes.insert(domain.notes.end(), arrangement.notes.begin(), arrangement.notes.end());

  segments.clear();
  DelaunayInput input;
  input.vertices = arrangement.vertices;
  for (const auto& edge : arrangement.edges) {
    const Point<2>&a = arrangement.vertices[edge.a], &b = arrangement.vertices[edge.b];
    segments.push_back({a, b, (b - a).norm()});
    input.edges.push_back({edge.a, edge.b});
  }
  for (const auto& ring : arrangement.rings) {
    if (signed_area(ring) < 0) input.holes.push_back(point_inside(ring));
  }
  const Lengths lengths = wanted_lengths(options, std::move(segments));
  input.largest_edge = [&](const Point<2>& p) { return kLargestEdge * lengths(p); };
  for (const auto& tip : tips_beside_edges(arrangement)) {
    if (region_.contains(tip)) input.inner_points.push_back(tip);
  }
  DelaunayOutput output = refine_delaunay(input);
  if (output.too_many) refuse(2.0 * input.most_vertices, options);
  domain.mesh = std::move(output.mesh);
  set_chains(arrangement, prepared, output.edge_paths, domain);
  set_regions(domain);
  report_small_angles(domain);
  return domain;
}

void DomainMesher::set_chains(const LineArrangement& arrangement,
                              const std::vector<FeatureLine>& prepared,
                              const std::vector<std::vector<int>>& paths,
                              DomainMesh& domain) const {
  int num_divided = 0;
  const LineArrangement::Edge* previous = nullptr;
  for (std::size_t e = 0; e < paths.size(); ++e) {
    const auto& edge = arrangement.edges[e];
    if (edge.line < 0) continue;
    if (paths[e].size() > 2) ++num_divided;
    const bool goes_on = previous && previous->line == edge.line && previous->b == edge.a &&
                         previous->body_left == edge.body_left &&
                         previous->body_right == edge.body_right;
    if (!goes_on) {
      const FeatureLine& line = prepared[edge.line];
      FeatureChain chain;
      chain.vertices = {paths[e].front()};
      chain.kind = line.kind;
      chain.corner = line.corner;
      chain.name = line.name;
      chain.body = edge.body_left && !edge.body_right ? BodySide::kLeft : BodySide::kNone;
      domain.chains.push_back(std::move(chain));
    }
    auto& vertices = domain.chains.back().vertices;
    vertices.insert(vertices.end(), paths[e].begin() + 1, paths[e].end());
    previous = &edge;
  }
  for (auto& chain : domain.chains) {
    chain.closed = chain.vertices.size() > 3 && chain.vertices.front() == chain.vertices.back();
    if (chain.closed) chain.vertices.pop_back();
  }
  if (num_divided > 0) {
    domain.notes.push_back(
        message(num_divided, " edges of feature lines were divided by the mesher."));
  }
}

/// Labels whole parts between the lines by one triangle each.
void DomainMesher::set_regions(DomainMesh& domain) const {
  auto& mesh = domain.mesh;
  const MeshTopology topology(mesh);
  std::vector<char> is_line(topology.edges().size(), 0);
  for (const auto& chain : domain.chains) {
    for (int e = 0; e < chain.num_edges(); ++e) {
      const int b = chain.vertices[(e + 1) % chain.vertices.size()];
      is_line[topology.edge_between(chain.vertices[e], b)] = 1;
    }
  }
  const auto corner = [&](int t, int k) { return mesh.vertices[mesh.simplices[t][k]]; };
  const auto twice_area = [&](int t) {
    return cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
  };
  mesh.regions.assign(mesh.simplices.size(), -1);
  std::vector<int> part;
  for (std::size_t start = 0; start < mesh.simplices.size(); ++start) {
    if (mesh.regions[start] >= 0) continue;
    part = {static_cast<int>(start)};
    mesh.regions[start] = 0;
    int largest = static_cast<int>(start);
    for (std::size_t i = 0; i < part.size(); ++i) {
      const auto& s = mesh.simplices[part[i]];
      if (twice_area(part[i]) > twice_area(largest)) largest = part[i];
      for (int k = 0; k < 3; ++k) {
        const int e = topology.edge_between(s[k], s[(k + 1) % 3]);
        if (is_line[e]) continue;
        for (int t : topology.edges()[e].triangles) {
          if (t < 0 || mesh.regions[t] >= 0) continue;
          mesh.regions[t] = 0;
          part.push_back(t);
        }
      }
    }
    const int label =
        bodies_.label_at((corner(largest, 0) + corner(largest, 1) + corner(largest, 2)) / 3);
    for (int t : part) mesh.regions[t] = label;
  }
}

constexpr double kTriangleTolerance = 0.05;

/// Bisection on the scale of all lengths, from 1 on; the count falls like its square. Keeps the mesh whose
/// count is nearest to the one wanted.
void search_scale(const DomainMesher& mesher, const MeshOptions& options, DomainMesh& best,
                  double& best_error) {
  double factor = 1, low = 0, high = std::numeric_limits<double>::infinity();
  for (int step = 0; step < 15; ++step) {
    DomainMesh domain = mesher.mesh(scaled(options, factor));
    const double count = static_cast<double>(domain.mesh.simplices.size());
    const double error = std::abs(count / options.num_triangles - 1);
    if (error < best_error) {
      best_error = error;
      best = std::move(domain);
    }
    if (best_error <= kTriangleTolerance) return;
    (count > options.num_triangles ? low : high) = factor;
    double next = factor * std::sqrt(count / options.num_triangles);
    if (!(next > low && next < high) || step % 4 == 3) {
      next = std::isinf(high) ? 2 * low : low == 0 ? high / 2 : 0.5 * (low + high);
    }
    factor = next;
  }
}

}  // namespace

DomainMesh mesh_domain(const RegionOfInterest& region, const std::vector<FeatureLine>& lines,
                       const MeshOptions& options) {
  check_feature_lines(lines);
  check_kinds_available(lines);
  const MeshOptions start = completed(region, options);
  const DomainMesher mesher(region, lines);
  if (options.num_triangles == 0) return mesher.mesh(start);
  DomainMesh best;
  double best_error = std::numeric_limits<double>::infinity();
  // Coarse meshes jump over some counts; another gradation reaches them.
  for (double gradation : {1.0, 0.8, 1.25, 0.6, 1.6}) {
    MeshOptions graded = start;
    graded.gradation *= gradation;
    search_scale(mesher, graded, best, best_error);
    if (best_error <= kTriangleTolerance) return best;
  }
  best.warnings.push_back(message("mesh: ", options.num_triangles, " triangles were asked for, ",
                                  best.mesh.simplices.size(), " is the nearest count found."));
  return best;
}

}  // namespace crease

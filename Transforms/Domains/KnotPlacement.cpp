#include "Transforms/Domains/KnotPlacement.h"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "Core/Error.h"
#include "Transforms/Domains/CreaseBands.h"
#include "Transforms/Domains/KnotNetCheck.h"
#include "Transforms/Domains/KnotTriangles.h"
#include "Transforms/Domains/VertexClouds.h"

namespace crease {
namespace {

constexpr double kSmallestShare = 0.05;    // of d(T) that every d(X_beta) near a line must keep
constexpr double kNearlyCollinear = 1e-3;  // of the radius
constexpr int kMostHalvings = 4;
constexpr double kWideBands = 0.05;  // share of the domain

void check_options(const KnotOptions& options) {
  const auto fail = [](const char* name, double value, const std::string& range) {
    throw InvalidInput(message("place_knots: ", name, " = ", value, " is not ", range, "."));
  };
  if (options.degree < 1 || options.degree > 5) fail("degree", options.degree, "between 1 and 5");
  if (options.smoothness < -1 || options.smoothness > options.degree - 1) {
    fail("smoothness", options.smoothness,
         message("between 0 and degree - 1 = ", options.degree - 1));
  }
  if (!(options.alpha > 0 && options.alpha < 1)) fail("alpha", options.alpha, "between 0 and 1");
  for (const auto& [name, value] : {std::pair("fan_body", options.fan_body),
                                    {"fan_both", options.fan_both},
                                    {"fan_corner", options.fan_corner}}) {
    if (!(value > 0 && value <= 0.4)) {
      fail(name, value, "between 0 and 0.4 (larger fans of neighbours overlap)");
    }
  }
}

/// The sketches of all clouds, brought into a valid state.
class CloudBuilder {
 public:
  CloudBuilder(const DomainMesh& domain, const KnotOptions& options)
      : domain_(domain),
        options_(options),
        topology_(domain.mesh),
        lines_(line_edges(domain, topology_)),
        vertex_clouds_(domain, topology_, lines_, options) {}

  PlacedKnots build();

 private:
  void check_mesh() const;
  void set_cloud(int vertex);
  TriangleClouds clouds(int triangle) const;
  bool nearly_collinear(int vertex) const;
  void turn_generic_clouds();
  bool turn_one_by_one();
  void shrink(int vertex);
  bool shrink_at_bad_triangles();
  bool shrink_at_border();
  void set_crease_edges();
  bool band_outside_body(int edge) const;
  void summarise();

  const DomainMesh& domain_;
  const KnotOptions& options_;
  MeshTopology topology_;
  std::vector<LineEdge> lines_;
  VertexClouds vertex_clouds_;
  std::vector<CloudSketch> sketches_;
  std::vector<double> turns_;  // of generic clouds, radians
  PlacedKnots result_;
};

void CloudBuilder::check_mesh() const {
  const auto& mesh = domain_.mesh;
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto& s = mesh.simplices[t];
    const Vector<2> a = mesh.vertices[s[1]] - mesh.vertices[s[0]];
    const Vector<2> b = mesh.vertices[s[2]] - mesh.vertices[s[0]];
    if (!(cross(a, b) > 1e-12 * std::max(a.squaredNorm(), b.squaredNorm()))) {
      throw InvalidInput(message("place_knots: triangle ", t, " (vertices ", s[0], ", ", s[1], ", ",
                                 s[2], ") is folded or flat."));
    }
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (topology_.triangles_at(static_cast<int>(v)).empty()) {
      throw InvalidInput(message("place_knots: vertex ", v, " belongs to no triangle."));
    }
  }
}

void CloudBuilder::set_cloud(int vertex) {
  const CloudSketch& sketch = sketches_[vertex];
  const Point<2>& v = domain_.mesh.vertices[vertex];
  auto& cloud = result_.net.clouds[vertex];
  cloud.assign(1, v);
  const int distinct = static_cast<int>(sketch.pattern.size());
  for (int k = 1; k < options_.degree; ++k) {
    const bool at_vertex = distinct == 0 || sketch.plan.radius == 0;
    cloud.push_back(
        at_vertex ? v
                  : Point<2>(v + sketch.plan.radius * sketch.pattern[std::min(k, distinct) - 1]));
  }
}

TriangleClouds CloudBuilder::clouds(int triangle) const {
  const auto& s = domain_.mesh.simplices[triangle];
  const auto& all = result_.net.clouds;
  return {all[s[0]], all[s[1]], all[s[2]]};
}

/// Whether a knot of a generic cloud lies almost on a line through two others of a triangle at the vertex.
bool CloudBuilder::nearly_collinear(int vertex) const {
  const double smallest = kNearlyCollinear * sketches_[vertex].plan.radius;
  const auto& own = result_.net.clouds[vertex];
  std::vector<Point<2>> others;
  for (int t : topology_.triangles_at(vertex)) {
    others.clear();
    for (int w : domain_.mesh.simplices[t]) {
      const auto& cloud = result_.net.clouds[w];
      others.insert(others.end(), cloud.begin(), cloud.end());
    }
    for (std::size_t k = 1; k < own.size(); ++k) {
      for (std::size_t i = 0; i < others.size(); ++i) {
        const Vector<2> a = others[i] - own[k];
        if (a.squaredNorm() == 0) continue;
        for (std::size_t j = 0; j < i; ++j) {
          const Vector<2> b = others[j] - own[k];
          const Vector<2> side = others[i] - others[j];
          if (b.squaredNorm() == 0 || side.squaredNorm() == 0) continue;
          const double longest2 = std::max({a.squaredNorm(), b.squaredNorm(), side.squaredNorm()});
          const double area = cross(a, b);
          if (area * area < smallest * smallest * longest2) return true;
        }
      }
    }
  }
  return false;
}

bool CloudBuilder::turn_one_by_one() {
  constexpr double kTurn = 0.1;
  constexpr int kMostTurns = 30;
  bool changed = false;
  for (std::size_t v = 0; v < sketches_.size(); ++v) {
    const int vertex = static_cast<int>(v);
    if (!sketches_[v].generic || sketches_[v].plan.radius == 0) continue;
    for (int attempt = 0; attempt < kMostTurns && nearly_collinear(vertex); ++attempt) {
      turns_[v] += kTurn;
      sketches_[v].pattern = vertex_clouds_.generic_pattern(vertex, turns_[v]);
      set_cloud(vertex);
      changed = true;
    }
  }
  return changed;
}

void CloudBuilder::turn_generic_clouds() {
  if (options_.degree < 2 || vertex_clouds_.num_distinct() == 0) return;
  if (!options_.structured) {
    for (int pass = 0; pass < 4 && turn_one_by_one(); ++pass) continue;
    return;
  }
  // Congruent clouds turn together.
  const auto any = [&] {
    for (std::size_t v = 0; v < sketches_.size(); ++v) {
      if (sketches_[v].generic && nearly_collinear(static_cast<int>(v))) return true;
    }
    return false;
  };
  double turn = 0;
  for (int attempt = 0; attempt < 60 && any(); ++attempt) {
    turn += 0.1;
    for (std::size_t v = 0; v < sketches_.size(); ++v) {
      if (!sketches_[v].generic) continue;
      sketches_[v].pattern = vertex_clouds_.generic_pattern(static_cast<int>(v), turn);
      set_cloud(static_cast<int>(v));
    }
  }
}

void CloudBuilder::shrink(int vertex) {
  VertexPlan& plan = sketches_[vertex].plan;
  if (++plan.halvings <= kMostHalvings) {
    plan.radius /= 2;
  } else {
    plan.radius = 0;
    plan.rule = VertexRule::kCollapsed;
    const Point<2>& v = domain_.mesh.vertices[vertex];
    result_.plan.warnings.push_back(
        message("the knots at (", v.x(), ", ", v.y(),
                ") mm were collapsed: no radius kept all triangles there "
                "valid. The mesh edges at it are free hinges."));
  }
  set_cloud(vertex);
}

bool CloudBuilder::shrink_at_bad_triangles() {
  std::vector<char> marked(sketches_.size(), 0);
  for (std::size_t t = 0; t < domain_.mesh.simplices.size(); ++t) {
    const auto& s = domain_.mesh.simplices[t];
    const bool near_line = std::any_of(s.begin(), s.end(), [&](int v) {
      return sketches_[v].on_line && sketches_[v].plan.radius > 0;
    });
    const auto triangle = clouds(static_cast<int>(t));
    const double smallest = smallest_knot_triangle(triangle, options_.degree);
    if (smallest > (near_line ? kSmallestShare : 1e-9) && has_core(triangle, options_.degree)) {
      continue;
    }
    for (int v : s) {
      if (sketches_[v].plan.radius > 0 && (sketches_[v].on_line || !near_line)) marked[v] = 1;
    }
  }
  bool any = false;
  for (std::size_t v = 0; v < marked.size(); ++v) {
    if (!marked[v]) continue;
    shrink(static_cast<int>(v));
    any = true;
  }
  return any;
}

bool CloudBuilder::shrink_at_border() {
  std::vector<char> marked(sketches_.size(), 0);
  bool any = false;
  for (const auto& [edge, area] : border_clouds_inside(result_.net, topology_)) {
    for (int v : topology_.edges()[edge].vertices) {
      if (sketches_[v].plan.radius == 0 || marked[v]) continue;
      marked[v] = 1;
      shrink(v);
      any = true;
    }
  }
  return any;
}

/// With a body on one side only, and knots at both ends that follow that side's rule.
bool CloudBuilder::band_outside_body(int edge) const {
  if (!lines_[edge].one_body()) return false;
  for (int v : topology_.edges()[edge].vertices) {
    if (sketches_[v].plan.radius == 0) continue;
    const VertexRule rule = sketches_[v].plan.rule;
    if (rule == VertexRule::kStraight || rule == VertexRule::kBorderMeeting) continue;
    if (rule != VertexRule::kFanned && rule != VertexRule::kCorner) return false;
    int num_one_body = 0;
    for (int e : topology_.edges_at(v)) num_one_body += lines_[e].is_line && lines_[e].one_body();
    if (num_one_body != 2) return false;
  }
  return true;
}

void CloudBuilder::set_crease_edges() {
  if (!options_.creases) return;
  for (std::size_t e = 0; e < lines_.size(); ++e) {
    if (!lines_[e].is_line) continue;
    result_.net.crease_edges.push_back(
        {topology_.edges()[e].vertices, band_outside_body(static_cast<int>(e))});
  }
}

void CloudBuilder::summarise() {
  FeaturePlan& plan = result_.plan;
  for (const auto& sketch : sketches_) {
    plan.vertices.push_back(sketch.plan);
    ++plan.counts[static_cast<std::size_t>(sketch.plan.rule)];
    plan.num_halved += sketch.plan.halvings > 0;
    plan.largest_turn_deg = std::max(plan.largest_turn_deg, sketch.plan.turn_deg);
    plan.largest_chord_offset = std::max(plan.largest_chord_offset, sketch.plan.chord_offset);
  }
  plan.num_crease_edges = static_cast<int>(result_.net.crease_edges.size());
  const CreaseBands bands(result_.net);
  double area = 0;
  for (std::size_t t = 0; t < domain_.mesh.simplices.size(); ++t) {
    const int triangle = static_cast<int>(t);
    const auto& s = domain_.mesh.simplices[t];
    const auto& p = domain_.mesh.vertices;
    area += 0.5 * cross(p[s[1]] - p[s[0]], p[s[2]] - p[s[0]]);
    if (bands.bands_in(triangle).empty()) continue;
    plan.band_area += bands.area_in(triangle);
    if (domain_.mesh.region(triangle) > 0) {
      plan.band_area_in_bodies += bands.area_in(triangle, /*only_body_side=*/true);
    }
  }
  plan.band_share = plan.band_area / area;
  if (plan.band_share > kWideBands) {
    plan.warnings.push_back(message("the bands of the creases cover ", 100 * plan.band_share,
                                    " % of the domain: the outlines are too coarse for their "
                                    "curvature; use shorter edges near lines."));
  }
}

PlacedKnots CloudBuilder::build() {
  check_mesh();
  const auto& mesh = domain_.mesh;
  result_.net.degree = options_.degree;
  result_.net.mesh = mesh;
  result_.net.clouds.resize(mesh.vertices.size());
  turns_.assign(mesh.vertices.size(), 0);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    sketches_.push_back(vertex_clouds_.sketch(static_cast<int>(v), result_.plan.warnings));
    set_cloud(static_cast<int>(v));
  }
  turn_generic_clouds();
  // Each vertex can be halved only so often, so this ends.
  while (shrink_at_bad_triangles() || shrink_at_border()) continue;
  set_crease_edges();
  summarise();
  return std::move(result_);
}

}  // namespace

std::string to_string(VertexRule rule) {
  constexpr std::array<const char*, kNumVertexRules> kNames = {
      "inner",     "border",   "straight", "fanned",         "tangent",    "corner",
      "collapsed", "junction", "line end", "border meeting", "inside body"};
  return kNames[static_cast<std::size_t>(rule)];
}

std::ostream& operator<<(std::ostream& stream, const FeaturePlan& plan) {
  stream << "vertices:";
  for (int r = 0; r < kNumVertexRules; ++r) {
    if (plan.counts[r] > 0) {
      stream << ' ' << to_string(static_cast<VertexRule>(r)) << ' ' << plan.counts[r] << ',';
    }
  }
  stream << " of " << plan.vertices.size() << "\ncrease edges: " << plan.num_crease_edges
         << ", largest turn " << plan.largest_turn_deg << " degrees, chords up to "
         << plan.largest_chord_offset << " mm off the curve, radius halved at " << plan.num_halved
         << " vertices\nbands: " << plan.band_area << " mm^2, " << 100 * plan.band_share
         << " % of the domain\n";
  for (const auto& warning : plan.warnings) stream << "warning: " << warning << '\n';
  return stream;
}

PlacedKnots place_knots(const DomainMesh& domain, const KnotOptions& options) {
  check_options(options);
  if (domain.mesh.simplices.empty()) throw InvalidInput("place_knots: the mesh has no triangle.");
  return CloudBuilder(domain, options).build();
}

}  // namespace crease

#pragma once

#include <optional>
#include <vector>

#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/MeshTopology.h"

namespace crease {

/// A cloud before it is scaled: knot k lies at v + radius * pattern[k - 1].
struct CloudSketch {
  VertexPlan plan;
  std::vector<Vector<2>> pattern;  ///< distinct knots besides the vertex
  bool generic = false;            ///< pattern may be turned freely
  bool on_line = false;
};

/// A mesh edge as part of a feature line. Lines without a body side count as having one on both sides.
struct LineEdge {
  bool is_line = false;
  bool body_left = false, body_right = false;  ///< walking from the lower to the higher vertex
  CornerRule corner = CornerRule::kBlunt;

  bool one_body() const { return body_left != body_right; }
};

/// Mesh edges of all chains; where two chains share an edge both bodies count.
std::vector<LineEdge> line_edges(const DomainMesh& domain, const MeshTopology& topology);

/// The rule of every vertex, before any check of the triangles.
class VertexClouds {
 public:
  VertexClouds(const DomainMesh& domain, const MeshTopology& topology,
               const std::vector<LineEdge>& lines, const KnotOptions& options);

  CloudSketch sketch(int vertex, std::vector<std::string>& warnings) const;
  /// Generic directions, turned by `turn` radians.
  std::vector<Vector<2>> generic_pattern(int vertex, double turn) const;
  int num_distinct() const { return num_distinct_; }

 private:
  struct Corner {  // of the border, domain on the left
    Vector<2> in, out;
  };
  struct Passage {  // of a line through an inner vertex, its body (if one) on the left
    Vector<2> in, out;
    double shorter_edge = 0;
    bool body = false;
    CornerRule corner = CornerRule::kBlunt;
  };

  double smallest_inradius(int vertex) const;
  bool inside_one_body(int vertex) const;
  std::optional<Corner> border_corner(int vertex) const;
  Passage passage(int vertex, int first_edge, int second_edge) const;
  bool body_left_of(int edge, int from) const;
  bool body_right_of(int edge, int from) const { return body_left_of(edge, other(edge, from)); }
  int other(int edge, int vertex) const { return topology_.other_end(edge, vertex); }
  void set_border(int vertex, const std::vector<int>& line_edges, CloudSketch& sketch,
                  std::vector<std::string>& warnings) const;
  void set_passage(int vertex, const Passage& passage, CloudSketch& sketch) const;
  void avoid_mesh_edges(int vertex, CloudSketch& sketch) const;
  void collapse(CloudSketch& sketch, VertexRule rule) const;
  const Point<2>& point(int vertex) const { return domain_.mesh.vertices[vertex]; }

  const DomainMesh& domain_;
  const MeshTopology& topology_;
  const std::vector<LineEdge>& lines_;
  const KnotOptions& options_;
  int num_distinct_;
  Point<2> lower_;
  Vector<2> extent_;
};

}  // namespace crease

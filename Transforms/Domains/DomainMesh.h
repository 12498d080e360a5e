#pragma once

#include <array>
#include <string>
#include <vector>

#include "Transforms/Domains/FeatureLine.h"
#include "Transforms/Domains/SimplexMesh.h"

namespace crease {

/// A feature line, or a piece of one, as edges of the mesh.
struct FeatureChain {
  std::vector<int> vertices;  ///< in order; the first is not repeated in a closed chain
  bool closed = false;
  FeatureKind kind = FeatureKind::kCrease;
  BodySide body = BodySide::kNone;  ///< left or none: chains run with their body on the left
  CornerRule corner = CornerRule::kBlunt;
  std::string name;

  int num_edges() const { return static_cast<int>(vertices.size()) - (closed ? 0 : 1); }
};

/// A triangulated domain with the feature lines that run along its edges. Its regions are body labels.
struct DomainMesh {
  SimplexMesh<2> mesh;
  std::vector<FeatureChain> chains;
  std::vector<std::string> notes;     ///< what was merged, clipped, split
  std::vector<std::string> warnings;  ///< what the user should look at
};

/// Figures for reports.
struct MeshFigures {
  int num_vertices = 0, num_edges = 0, num_triangles = 0;
  double area = 0;  ///< mm^2
  double smallest_angle_deg = 0;
  double smallest_edge = 0, mean_edge = 0, largest_edge = 0;  ///< mm
};
MeshFigures mesh_figures(const SimplexMesh<2>& mesh);
std::array<double, 3> corner_angles_deg(const SimplexMesh<2>& mesh,
                                        const std::array<int, 3>& triangle);

/// Joins feature lines to a mesh whose edges they follow (structured triangulations); closed lines with a body set the
/// regions of the triangles inside.
/// @throws InvalidInput naming line and point where a line leaves the mesh's edges.
DomainMesh attach_feature_lines(SimplexMesh<2> mesh, const std::vector<FeatureLine>& lines);

}  // namespace crease

#pragma once

#include <array>
#include <iosfwd>
#include <string>
#include <vector>

#include "Transforms/Domains/DomainMesh.h"
#include "Transforms/Domains/KnotNet.h"

namespace crease {

/// Where the knots of border vertices go: into the wedge outside the domain; onto straight stretches of the border,
/// corners collapsed (boundary values then depend on the border's control points alone); or all onto the vertex.
enum class BorderRule { kOutside, kOnStraightBorder, kCollapsed };

/// How far from their vertices knots lie, and what creases do to them.
struct KnotOptions {
  int degree = 3;
  /// Continuous derivatives away from creases, 0 to degree - 1; -1: degree - 1. With less, the last of
  /// `smoothness` distinct knots per vertex is repeated: (t0,t1,t1,t0) is a C1 cubic with few cells.
  int smoothness = -1;
  double alpha = 0.5;      ///< cloud radius over the smallest inradius at the vertex, in (0, 1)
  bool creases = true;     ///< false: feature lines stay mesh edges with ordinary knots
  double fan_body = 0.25;  ///< fan radius over the shorter line edge, body on one side; at most 0.4
  double fan_both = 0.35;  ///< the same without a body, or with bodies on both sides
  double fan_corner = 0.2;  ///< the same where the line turns by more than 60 degrees
  BorderRule border = BorderRule::kOutside;
  bool structured =
      false;  ///< one direction for all inner clouds: congruent triangles, congruent knots
  bool collapse_inside_bodies =
      false;  ///< vertices with one body all round: all knots at the vertex
  /// All knots at their vertices: Lagrange's finite elements of this degree, continuous and no more, for
  /// comparisons. Bending energies do not see their edges, which are hinges.
  bool collapse_all = false;
};

/// What happened to a vertex.
enum class VertexRule {
  kInner,          ///< generic cloud
  kBorder,         ///< knots outside the domain, or along its border
  kStraight,       ///< on a line that goes straight on: knots on it
  kFanned,         ///< on a turning line with a body on one side: knots on the outer side
  kTangent,        ///< on a turning line without a body: knots on the tangent
  kCorner,         ///< line turns by more than 60 degrees, blunted: as fanned or tangent, smaller
  kCollapsed,      ///< all knots at the vertex
  kJunction,       ///< three or more line edges: generic cloud
  kLineEnd,        ///< a line ends here inside the domain: generic cloud
  kBorderMeeting,  ///< a line meets the border: knots on its prolongation outside
  kInsideBody      ///< collapsed, for a body lies all round
};
inline constexpr int kNumVertexRules = 11;
std::string to_string(VertexRule rule);

/// What was decided at one vertex.
struct VertexPlan {
  VertexRule rule = VertexRule::kInner;
  double radius = 0;        ///< mm, after halving
  double turn_deg = 0;      ///< of the line; 0 off lines
  double chord_offset = 0;  ///< mm, edge length times turn / 8
  int halvings = 0;         ///< times the radius was halved to keep the triangles valid
};

/// What was decided, vertex by vertex and in all.
struct FeaturePlan {
  std::vector<VertexPlan> vertices;
  std::array<int, kNumVertexRules> counts{};  ///< vertices per rule
  int num_crease_edges = 0;
  int num_halved = 0;              ///< vertices whose radius was halved
  double band_area = 0;            ///< mm^2 of the bands in which creases bend
  double band_share = 0;           ///< of the domain
  double band_area_in_bodies = 0;  ///< mm^2 inside the body of the line itself
  double largest_turn_deg = 0;
  double largest_chord_offset =
      0;  ///< mm between a line's edges and the smooth curve they stand for
  std::vector<std::string> warnings;

  int count(VertexRule rule) const { return counts[static_cast<std::size_t>(rule)]; }
};
std::ostream& operator<<(std::ostream& stream, const FeaturePlan& plan);

/// The knots, and how they came to lie where they do.
struct PlacedKnots {
  KnotNet<2> net;
  FeaturePlan plan;
};

/// Gives every vertex of a mesh its cloud of knots, by the vertex's place: generic clouds inside, spread by
/// the golden angle; outside the domain on its border; near the line on creases, fanned so that the narrow
/// band between the clouds of a crease edge lies wholly outside the line's body.
///
/// Radii are halved, and clouds collapsed in the end, until every triangle spanned by knots that a basis
/// function uses is positive and has at least a twentieth of its mesh triangle's area.
///
/// @throws InvalidInput for options out of range or a mesh that is folded.
PlacedKnots place_knots(const DomainMesh& domain, const KnotOptions& options = {});

}  // namespace crease

#pragma once

#include <string>
#include <vector>

#include "Transforms/Domains/Polygon.h"

namespace crease {

/// What a map may do across a feature line: bend sharply, slide along it, or tear.
enum class FeatureKind { kCrease, kSlide, kSlit };
/// On which side of a line, walked along its points, a rigid body lies. `kAutomatic`: inside a closed
/// line, nowhere beside an open one.
enum class BodySide { kAutomatic, kLeft, kRight, kNone };
/// What happens where a line turns by more than 60 degrees: rounded over a quarter of an edge, or
/// sharp, with hinges along the mesh edges that meet there.
enum class CornerRule { kBlunt, kCollapse };

/// An open or closed polyline in the domain along which a map is less smooth than elsewhere.
struct FeatureLine {
  Polyline points;      ///< mm, in order; the first is not repeated in a closed line
  bool closed = false;  ///< an edge runs from the last point to the first
  FeatureKind kind = FeatureKind::kCrease;
  std::vector<FeatureKind> edge_kinds;  ///< per edge, when the kind changes along the line
  BodySide body = BodySide::kAutomatic;
  CornerRule corner = CornerRule::kBlunt;
  std::string name;     ///< for messages
  int left_label = 0;   ///< number of the rigid body on the left; 0: none, or not numbered yet
  int right_label = 0;  ///< the same on the right

  int num_edges() const { return static_cast<int>(points.size()) - (closed ? 0 : 1); }
  FeatureKind edge_kind(int edge) const {
    return edge_kinds.empty() ? kind : edge_kinds[static_cast<std::size_t>(edge)];
  }
};

std::string to_string(FeatureKind kind);
std::string to_string(BodySide side);
std::string to_string(CornerRule rule);

/// The side of the body with `automatic` replaced: inside a closed line, none for an open one.
BodySide body_side(const FeatureLine& line);

/// The same line walked the other way: its sides change names.
FeatureLine reversed(const FeatureLine& line);

/// Checks every line: at least two points (three edges if closed), all finite, a kind for every edge.
/// @throws InvalidInput naming the line and the point.
void check_feature_lines(const std::vector<FeatureLine>& lines);

/// @throws InvalidInput for kinds that domains cannot be built with in this version (slide, slit).
void check_kinds_available(const std::vector<FeatureLine>& lines);

/// Gives each closed line with a body but no label the next free number, from 1 upwards in order.
std::vector<FeatureLine> with_body_labels(std::vector<FeatureLine> lines);

/// Which bodies hold a point, by the winding of the lines that border them. The lines of one label form
/// closed rings together; a body may have holes, and a ring with its body outside fills the rest of the domain.
class BodyRegions {
 public:
  explicit BodyRegions(const std::vector<FeatureLine>& lines);
  /// The lowest label of a body that holds p; 0: none.
  int label_at(const Point<2>& p) const;

 private:
  struct Edge {
    Point<2> a, b;  // the body lies on the left
  };
  struct Body {
    int label = 0;
    bool everywhere_else = false;  // all its rings have the body outside
    std::vector<Edge> edges;
  };
  std::vector<Body> bodies_;
};

}  // namespace crease

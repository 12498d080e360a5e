#include "Transforms/Domains/FeatureLine.h"

#include <algorithm>
#include <map>

#include "Core/Error.h"

namespace crease {
namespace {

std::string describe(const FeatureLine& line, std::size_t number) {
  return line.name.empty() ? message("feature line ", number + 1)
                           : message("feature line ", number + 1, " (", line.name, ")");
}

}  // namespace

std::string to_string(FeatureKind kind) {
  return kind == FeatureKind::kCrease ? "crease" : kind == FeatureKind::kSlide ? "slide" : "slit";
}

std::string to_string(BodySide side) {
  switch (side) {
    case BodySide::kLeft:
      return "left";
    case BodySide::kRight:
      return "right";
    case BodySide::kNone:
      return "none";
    case BodySide::kAutomatic:
      break;
  }
  return "automatic";
}

std::string to_string(CornerRule rule) { return rule == CornerRule::kBlunt ? "blunt" : "collapse"; }

BodySide body_side(const FeatureLine& line) {
  if (line.body != BodySide::kAutomatic) return line.body;
  if (!line.closed) return BodySide::kNone;
  return signed_area(line.points) >= 0 ? BodySide::kLeft : BodySide::kRight;
}

FeatureLine reversed(const FeatureLine& line) {
  FeatureLine result = line;
  std::reverse(result.points.begin(), result.points.end());
  std::reverse(result.edge_kinds.begin(), result.edge_kinds.end());
  // Edge i of a closed line ends in point i + 1: after reversing, the closing edge must stay last.
  if (line.closed && !result.edge_kinds.empty()) {
    std::rotate(result.edge_kinds.begin(), result.edge_kinds.begin() + 1, result.edge_kinds.end());
  }
  std::swap(result.left_label, result.right_label);
  if (line.body == BodySide::kLeft) result.body = BodySide::kRight;
  if (line.body == BodySide::kRight) result.body = BodySide::kLeft;
  return result;
}

void check_feature_lines(const std::vector<FeatureLine>& lines) {
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const FeatureLine& line = lines[l];
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      if (!line.points[i].allFinite()) {
        throw InvalidInput(message(describe(line, l), ": point ", i + 1, " (", line.points[i].x(),
                                   ", ", line.points[i].y(),
                                   ") mm is not finite; correct or delete it."));
      }
    }
    if (line.points.size() < 2) {
      throw InvalidInput(message(describe(line, l), " has ", line.points.size(),
                                 " point(s); a line needs at least two."));
    }
    if (line.closed && line.points.size() < 3) {
      throw InvalidInput(message(describe(line, l), " is closed but has only ", line.points.size(),
                                 " edges; a closed line needs at least three."));
    }
    if (!line.edge_kinds.empty() && static_cast<int>(line.edge_kinds.size()) != line.num_edges()) {
      throw InvalidInput(message(describe(line, l), " has ", line.num_edges(), " edges but ",
                                 line.edge_kinds.size(), " kinds; give one per edge or none."));
    }
    if (line.left_label < 0 || line.right_label < 0) {
      throw InvalidInput(message(describe(line, l), ": body labels must not be negative."));
    }
  }
}

void check_kinds_available(const std::vector<FeatureLine>& lines) {
  for (std::size_t l = 0; l < lines.size(); ++l) {
    for (int e = 0; e < lines[l].num_edges(); ++e) {
      const FeatureKind kind = lines[l].edge_kind(e);
      if (kind == FeatureKind::kCrease) continue;
      throw InvalidInput(message(describe(lines[l], l), ": ", to_string(kind),
                                 " lines are not available yet in this version; use crease."));
    }
  }
}

std::vector<FeatureLine> with_body_labels(std::vector<FeatureLine> lines) {
  int next = 1;
  for (const auto& line : lines) next = std::max({next, line.left_label + 1, line.right_label + 1});
  for (auto& line : lines) {
    const BodySide side = body_side(line);
    if (!line.closed || line.left_label > 0 || line.right_label > 0) continue;
    if (side == BodySide::kLeft) line.left_label = next++;
    if (side == BodySide::kRight) line.right_label = next++;
  }
  return lines;
}

BodyRegions::BodyRegions(const std::vector<FeatureLine>& lines) {
  std::map<int, Body> bodies;
  std::map<int, double> areas;  // of the rings, positive if the body is inside them
  for (const auto& line : lines) {
    for (const auto& [label, sign] : {std::pair(line.left_label, 1), {line.right_label, -1}}) {
      if (label <= 0) continue;
      Body& body = bodies[label];
      body.label = label;
      for (int e = 0; e < line.num_edges(); ++e) {
        const Point<2>& a = line.points[e];
        const Point<2>& b = line.points[(e + 1) % line.points.size()];
        body.edges.push_back(sign > 0 ? Edge{a, b} : Edge{b, a});
        areas[label] += 0.5 * sign * cross(a - lines[0].points[0], b - lines[0].points[0]);
      }
    }
  }
  for (auto& [label, body] : bodies) {
    body.everywhere_else = areas[label] < 0;
    bodies_.push_back(std::move(body));
  }
}

int BodyRegions::label_at(const Point<2>& p) const {
  for (const auto& body : bodies_) {
    int winding = body.everywhere_else ? 1 : 0;
    for (const auto& [a, b] : body.edges) {
      if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
      const double side = cross(b - a, p - a);
      if (b.y() > a.y() && side > 0) ++winding;
      if (b.y() < a.y() && side < 0) --winding;
    }
    if (winding > 0) return body.label;
  }
  return 0;
}

}  // namespace crease

#include "Applications/Report/ReportJson.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

/// To a hundredth of a pixel.
double rounded(double value) { return std::round(100 * value) / 100; }

/// An SVG path: the first point, then steps from point to point (of rounded points, so that errors do not
/// add up).
std::string path_text(const std::vector<std::vector<Point<2>>>& lines) {
  std::string text;
  for (const auto& line : lines) {
    Point<2> last = Point<2>::Zero();
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Point<2> p = {rounded(line[i].x()), rounded(line[i].y())};
      const Vector<2> step = p - last;
      fmt::format_to(std::back_inserter(text), "{}{:.6g} {:.6g}",
                     i == 0   ? "M"
                     : i == 1 ? "l"
                              : " ",
                     i == 0 ? p.x() : rounded(step.x()), i == 0 ? p.y() : rounded(step.y()));
      last = p;
    }
  }
  return text;
}

const char* name(ReportOverlay::Look look) {
  switch (look) {
    case ReportOverlay::Look::kGrid:
      return "grid";
    case ReportOverlay::Look::kFeature:
      return "feature";
    case ReportOverlay::Look::kLandmark:
      return "landmark";
    case ReportOverlay::Look::kPlace:
      break;
  }
  return "place";
}

Json to_json(const ReportPlane& plane) {
  Json slices = Json::array();
  for (const auto& slice : plane.slices) {
    slices.push_back({{"label", slice.label}, {"origin", slice.origin_mm}});
  }
  return {{"name", plane.name},          {"width", plane.width},
          {"height", plane.height},      {"widthMm", plane.width_mm},
          {"heightMm", plane.height_mm}, {"right", plane.right_mm},
          {"down", plane.down_mm},       {"slices", slices}};
}

Json to_json(const ReportLayer& layer) {
  const ReportScale& scale = layer.scale;
  return {{"name", layer.name},
          {"lower", scale.lower},
          {"upper", scale.upper},
          {"logarithmic", scale.logarithmic},
          {"first", scale.first},
          {"special", scale.special},
          {"specialColour", scale.special_colour},
          {"colours", scale.colours},
          {"ticks", scale.ticks},
          {"label", scale.label}};
}

Json to_json(const ReportOverlay& overlay) {
  Json planes = Json::array();
  for (const auto& plane : overlay.drawings) {
    Json slices = Json::array();
    for (const auto& drawing : plane) {
      Json marks = Json::array();
      for (const auto& mark : drawing.marks) {
        marks.push_back({rounded(mark.at.x()), rounded(mark.at.y()), mark.ring, mark.label});
      }
      slices.push_back({{"path", path_text(drawing.lines)}, {"marks", marks}});
    }
    planes.push_back(slices);
  }
  return {{"name", overlay.name}, {"look", name(overlay.look)}, {"planes", planes}};
}

Json to_json(const ReportStack& stack) {
  Json json = {{"planes", Json::array()},
               {"layers", Json::array()},
               {"overlays", Json::array()},
               {"note", stack.note}};
  for (const auto& plane : stack.planes) json["planes"].push_back(to_json(plane));
  for (const auto& layer : stack.layers) json["layers"].push_back(to_json(layer));
  for (const auto& overlay : stack.overlays) json["overlays"].push_back(to_json(overlay));
  return json;
}

Json to_json(const ReportViewer& viewer) {
  Json places = Json::array();
  for (const auto& place : viewer.places) {
    places.push_back({{"text", place.text}, {"slices", place.slices}});
  }
  return {{"kind", viewer.kind == ReportViewer::Kind::kCompare ? "compare" : "maps"},
          {"stack", viewer.stack},
          {"title", viewer.title},
          {"layers", viewer.layers},
          {"overlays", viewer.overlays},
          {"moreOverlays", viewer.more_overlays},
          {"contrast", viewer.contrast},
          {"places", places}};
}

Json to_json(const ReportPlot& plot) {
  Json sections = Json::array(), curves = Json::array();
  for (const auto& section : plot.sections) {
    sections.push_back({{"name", section.name}, {"count", section.count}});
  }
  for (const auto& curve : plot.curves) {
    Json values = Json::array();
    for (const auto& value : curve.values) values.push_back(value ? Json(*value) : Json());
    curves.push_back({{"name", curve.name}, {"values", values}});
  }
  return {{"title", plot.title},
          {"x", plot.x_label},
          {"y", plot.y_label},
          {"sections", sections},
          {"curves", curves}};
}

template <typename Part>
Json list(const std::vector<Part>& parts) {
  Json json = Json::array();
  for (const Part& part : parts) json.push_back(to_json(part));
  return json;
}

}  // namespace

std::string report_json(const std::vector<ReportStack>& stacks,
                        const std::vector<ReportViewer>& viewers,
                        const std::vector<ReportPlot>& plots) {
  const Json json = {{"stacks", list(stacks)}, {"viewers", list(viewers)}, {"plots", list(plots)}};
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      result += "\\u003c";
    } else {
      result += c;
    }
  }
  return result;
}

}  // namespace crease

#include <fstream>
#include <nlohmann/json.hpp>

#include "Core/Error.h"
#include "Transforms/Domains/FeatureLineFile.h"

namespace crease {
namespace {

using Json = nlohmann::json;

/// A control point in LPS; Slicer's own frame is RAS, with x and y the other way round.
Point<2> position(const Json& control_point, bool ras, const std::string& place) {
  const auto it = control_point.find("position");
  if (it == control_point.end() || !it->is_array() || it->size() < 2 || !(*it)[0].is_number() ||
      !(*it)[1].is_number()) {
    throw InvalidInput(message(place, ": 'position' must be a list of numbers."));
  }
  const Point<2> p((*it)[0].get<double>(), (*it)[1].get<double>());
  return ras ? Point<2>(-p) : p;
}

/// Slicer writes LPS and RAS by name; its old files write 1 for LPS and 0 for RAS.
bool is_ras(const Json& markup, const std::string& place) {
  const auto it = markup.find("coordinateSystem");
  if (it == markup.end()) return false;
  if (*it == "RAS" || *it == 0 || *it == "0") return true;
  if (*it == "LPS" || *it == 1 || *it == "1") return false;
  throw InvalidInput(
      message(place, ": coordinate system ", it->dump(), " is neither LPS nor RAS."));
}

FeatureLine read_curve(const Json& markup, bool closed, const std::string& place) {
  FeatureLine line;
  line.closed = closed;
  const bool ras = is_ras(markup, place);
  const Json points = markup.value("controlPoints", Json::array());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string where = message(place, ", control point ", i + 1);
    if (!points[i].is_object()) throw InvalidInput(message(where, ": is not an object."));
    if (points[i].value("positionStatus", "defined") != "defined") continue;
    line.points.push_back(position(points[i], ras, where));
  }
  const std::size_t needed = closed ? 3 : 2;
  if (line.points.size() < needed) {
    throw InvalidInput(
        message(place, ": has ", line.points.size(), " placed point(s), but needs ", needed, "."));
  }
  return line;
}

}  // namespace

std::vector<FeatureLine> read_slicer_curves(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream) throw FileError(message(path.string(), ": cannot be opened."));
  Json file;
  try {
    file = Json::parse(stream);
  } catch (const Json::parse_error& error) {
    throw InvalidInput(message(path.string(), ": is not valid JSON (byte ", error.byte, ")."));
  }
  if (!file.is_object() || !file.contains("markups") || !file["markups"].is_array()) {
    throw InvalidInput(message(
        path.string(), ": has no list 'markups'; expected curves as written ", "by 3D Slicer."));
  }
  std::vector<FeatureLine> lines;
  try {
    for (std::size_t m = 0; m < file["markups"].size(); ++m) {
      const Json& markup = file["markups"][m];
      const std::string place = message(path.string(), ", markup ", m + 1);
      const std::string type = markup.value("type", "");
      if (type != "Curve" && type != "ClosedCurve" && type != "Line") {
        throw InvalidInput(
            message(place, ": type '", type, "' is not a Curve, ClosedCurve or Line."));
      }
      lines.push_back(read_curve(markup, type == "ClosedCurve", place));
      lines.back().name = std::to_string(m + 1);
    }
  } catch (const Json::exception& error) {
    throw InvalidInput(message(path.string(), ": ", error.what()));
  }
  if (lines.empty()) throw InvalidInput(message(path.string(), ": holds no curve."));
  return lines;
}

}  // namespace crease

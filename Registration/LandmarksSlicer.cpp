#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "Core/Error.h"
#include "Registration/Landmarks.h"

namespace crease {
namespace {

using Json = nlohmann::json;

struct NamedPoint {
  std::string name;
  Point<3> position;  // LPS, mm
};

std::ifstream open(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream) throw FileError(message(path.string(), ": cannot be opened; check the name."));
  return stream;
}

// Slicer writes the frame by name; its old files write 0 for RAS and 1 for LPS.
bool is_ras(const std::string& frame, const std::string& place) {
  if (frame == "RAS" || frame == "0") return true;
  if (frame == "LPS" || frame == "1") return false;
  throw InvalidInput(message(place, ": coordinate system '", frame, "' is neither LPS nor RAS."));
}

Point<3> to_lps(const Point<3>& p, bool ras) { return ras ? Point<3>(-p[0], -p[1], p[2]) : p; }

std::vector<NamedPoint> points_of_markup(const Json& markup, const std::string& place) {
  const Json frame = markup.value("coordinateSystem", Json("LPS"));
  const bool ras = is_ras(frame.is_string() ? frame.get<std::string>() : frame.dump(), place);
  std::vector<NamedPoint> points;
  const Json list = markup.value("controlPoints", Json::array());
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].value("positionStatus", "defined") != "defined") continue;
    const Json position = list[i].value("position", Json());
    const auto is_number = [](const Json& x) { return x.is_number(); };
    if (position.size() != 3 || !std::all_of(position.begin(), position.end(), is_number)) {
      throw InvalidInput(message(place, ", control point ", i + 1, ": position ", position.dump(),
                                 " is not a list of three numbers."));
    }
    const Point<3> p(position[0], position[1], position[2]);
    points.push_back({list[i].value("label", ""), to_lps(p, ras)});
  }
  return points;
}

std::vector<NamedPoint> read_markups_json(const std::filesystem::path& path) {
  auto stream = open(path);
  try {
    const Json file = Json::parse(stream);
    const Json markups = file.is_object() ? file.value("markups", Json::array()) : Json::array();
    for (std::size_t m = 0; m < markups.size(); ++m) {
      if (markups[m].value("type", "") != "Fiducial") continue;
      return points_of_markup(markups[m], message(path.string(), ", markup ", m + 1));
    }
  } catch (const Json::exception& error) {
    throw InvalidInput(message(path.string(), ": is not a markups file: ", error.what()));
  }
  throw InvalidInput(message(path.string(), ": holds no point list (markup of type 'Fiducial')."));
}

double coordinate(const std::string& cell, const std::string& place) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
    throw InvalidInput(message(place, ": '", cell, "' is not a finite number."));
  }
  return value;
}

// id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,... ; the frame stands in a comment above.
std::vector<NamedPoint> read_fcsv(const std::filesystem::path& path) {
  constexpr std::size_t kLabelColumn = 11;
  auto stream = open(path);
  std::vector<NamedPoint> points;
  bool ras = true;
  std::string line;
  for (int row = 1; std::getline(stream, line); ++row) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::string place = message(path.string(), ", row ", row);
    constexpr std::string_view kFrame = "# CoordinateSystem = ";
    if (line.starts_with(kFrame)) ras = is_ras(line.substr(kFrame.size()), place);
    if (line.empty() || line.front() == '#') continue;
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    if (cells.size() < 4) {
      throw InvalidInput(message(place, ": ", cells.size(), " cells, expected id,x,y,z,..."));
    }
    const Point<3> p(coordinate(cells[1], place + ", column x"),
                     coordinate(cells[2], place + ", column y"),
                     coordinate(cells[3], place + ", column z"));
    points.push_back({cells.size() > kLabelColumn ? cells[kLabelColumn] : "", to_lps(p, ras)});
  }
  return points;
}

std::vector<NamedPoint> read_points(const std::filesystem::path& path) {
  auto points = path.extension() == ".fcsv" ? read_fcsv(path) : read_markups_json(path);
  if (points.empty()) throw InvalidInput(message(path.string(), ": holds no placed point."));
  return points;
}

// Brings `points` into the order of `names` if both hold the same names, each once.
void sort_by_names(std::vector<NamedPoint>& points, const std::vector<NamedPoint>& names) {
  std::map<std::string, NamedPoint> by_name;
  for (const auto& p : points) by_name[p.name] = p;
  std::map<std::string, int> wanted;
  for (const auto& p : names) wanted[p.name] = 1;
  if (by_name.size() != points.size() || wanted.size() != points.size()) return;
  for (const auto& p : names) {
    if (!by_name.contains(p.name)) return;
  }
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = by_name[names[i].name];
}

}  // namespace

template <int Dim>
Landmarks<Dim> read_slicer_landmarks(const std::filesystem::path& fixed,
                                     const std::filesystem::path& moving) {
  const auto fixed_points = read_points(fixed);
  auto moving_points = read_points(moving);
  if (fixed_points.size() != moving_points.size()) {
    throw InvalidInput(message(fixed.string(), " holds ", fixed_points.size(), " points, but ",
                               moving.string(), " holds ", moving_points.size(),
                               "; landmarks come in pairs."));
  }
  sort_by_names(moving_points, fixed_points);
  Landmarks<Dim> landmarks;
  for (std::size_t i = 0; i < fixed_points.size(); ++i) {
    landmarks.fixed.push_back(fixed_points[i].position.template head<Dim>());
    landmarks.moving.push_back(moving_points[i].position.template head<Dim>());
    landmarks.names.push_back(fixed_points[i].name);
  }
  return landmarks;
}

template Landmarks<2> read_slicer_landmarks<2>(const std::filesystem::path&,
                                               const std::filesystem::path&);
template Landmarks<3> read_slicer_landmarks<3>(const std::filesystem::path&,
                                               const std::filesystem::path&);

}  // namespace crease

#include "Registration/PointFileSlicer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "Core/Error.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

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

double coordinate(const std::string& cell, const std::string& place) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
    throw InvalidInput(message(place, ": '", cell, "' is not a finite number."));
  }
  return value;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

SlicerTable::SlicerTable(const std::filesystem::path& path) {
  constexpr std::size_t kLabelColumn = 11;
  auto stream = open(path);
  bool ras = true;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines_.push_back(line);
    const std::string place = message(path.string(), ", row ", lines_.size());
    constexpr std::string_view kFrame = "# CoordinateSystem = ";
    if (line.starts_with(kFrame)) ras = is_ras(line.substr(kFrame.size()), place);
    if (line.empty() || line.front() == '#') continue;
    const auto cells = cells_of(line);
    if (cells.size() < 4) {
      throw InvalidInput(message(place, ": ", cells.size(), " cells, expected id,x,y,z,..."));
    }
    const Point<3> p(coordinate(cells[1], place + ", column x"),
                     coordinate(cells[2], place + ", column y"),
                     coordinate(cells[3], place + ", column z"));
    points_.push_back(turned(p, ras));
    names_.push_back(cells.size() > kLabelColumn ? cells[kLabelColumn] : "");
    rows_.push_back({lines_.size() - 1, ras});
  }
  if (points_.empty()) throw InvalidInput(message(path.string(), ": holds no placed point."));
}

std::string SlicerTable::with_points(const std::vector<Point<3>>& points) const {
  std::vector<std::string> lines = lines_;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    std::string& line = lines[rows_[k].line];
    const Point<3> p = turned(points[k], rows_[k].ras);
    std::size_t begin = line.find(',') + 1, end = begin;
    for (int a = 0; a < 3; ++a) end = std::min(line.size(), line.find(',', end + (a > 0)));
    std::ostringstream text;
    text.precision(17);
    text << p[0] << ',' << p[1] << ',' << p[2];
    line.replace(begin, end - begin, text.str());
  }
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

struct SlicerMarkups::Contents {  // NOLINT(bugprone-exception-escape): JSON's move does not throw
  /// Which control point of which markup a point is.
  struct Place {
    std::size_t markup, control_point;
    bool ras;
  };
  Json json;
  std::vector<Place> places;
};

SlicerMarkups::~SlicerMarkups() = default;

SlicerMarkups::SlicerMarkups(const std::filesystem::path& path, bool only_first_list) {
  auto stream = open(path);
  auto contents = std::make_unique<Contents>();
  const auto read_markup = [&](const Json& markup, std::size_t m) {
    const std::string place = message(path.string(), ", markup ", m + 1);
    const Json frame = markup.value("coordinateSystem", Json("LPS"));
    const bool ras = is_ras(frame.is_string() ? frame.get<std::string>() : frame.dump(), place);
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
      points_.push_back(turned(p, ras));
      names_.push_back(list[i].value("label", ""));
      contents->places.push_back({m, i, ras});
    }
  };
  bool found = false;
  try {
    contents->json = Json::parse(stream);
    const Json markups =
        contents->json.is_object() ? contents->json.value("markups", Json::array()) : Json::array();
    for (std::size_t m = 0; m < markups.size() && !(found && only_first_list); ++m) {
      if (only_first_list && markups[m].value("type", "") != "Fiducial") continue;
      found = true;
      read_markup(markups[m], m);
    }
  } catch (const Json::exception& error) {
    throw InvalidInput(message(path.string(), ": is not a markups file: ", error.what()));
  }
  if (!found) {
    throw InvalidInput(message(
        path.string(), only_first_list ? ": holds no point list (markup of type 'Fiducial')."
                                       : ": holds no markup."));
  }
  if (points_.empty()) throw InvalidInput(message(path.string(), ": holds no placed point."));
  contents_ = std::move(contents);
}

std::string SlicerMarkups::with_points(const std::vector<Point<3>>& points) const {
  Json json = contents_->json;
  for (std::size_t k = 0; k < contents_->places.size(); ++k) {
    const auto& place = contents_->places[k];
    Json& point = json["markups"][place.markup]["controlPoints"][place.control_point];
    const Point<3> p = turned(points[k], place.ras);
    if (p.allFinite()) {
      point["position"] = {p[0], p[1], p[2]};
    } else {  // JSON has no NaN
      point["position"] = {0.0, 0.0, 0.0};
      point["positionStatus"] = "undefined";
    }
  }
  return json.dump(4) + '\n';
}

}  // namespace crease

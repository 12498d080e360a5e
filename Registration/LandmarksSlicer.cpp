#include <map>

#include "Core/Error.h"
#include "Registration/Landmarks.h"
#include "Registration/PointFileSlicer.h"

namespace crease {
namespace {

struct NamedPoint {
  std::string name;
  Point<3> position;  // LPS, mm
};

std::vector<NamedPoint> read_points(const std::filesystem::path& path) {
  const auto list = [&](const PointFile& file) {
    std::vector<NamedPoint> points;
    for (std::size_t k = 0; k < file.points().size(); ++k) {
      points.push_back({file.names()[k], file.points()[k]});
    }
    return points;
  };
  if (path.extension() == ".fcsv") return list(SlicerTable(path));
  return list(SlicerMarkups(path, /*only_first_list=*/true));
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

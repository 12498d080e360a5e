#include "Registration/Phantoms/MammogramTruth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "Core/Error.h"
#include "Registration/Phantoms/MammogramOutline.h"

namespace crease {
namespace {

constexpr int kOutlinePoints = 4000, kPectoralPoints = 33, kContourPairs = 40;
constexpr double kQuarter = 0.5 * std::numbers::pi;

Polyline in_mm(Polyline points) {
  for (auto& p : points) p *= kMammogramWidthMm;
  return points;
}

std::vector<DuctMark> marks_in_mm(const std::vector<Duct>& ducts) {
  std::vector<DuctMark> marks = duct_marks(ducts);
  for (auto& mark : marks) mark.position *= kMammogramWidthMm;
  return marks;
}

// The first run of points of T's image of a line that lie in the frame.
Polyline visible_part(const Polyline& line, const MammogramMap& map, const Box<2>& frame) {
  Polyline points;
  for (const auto& x : line) {
    const Point<2> y = map(x);
    if (frame.contains(y)) {
      points.push_back(y);
    } else if (!points.empty()) {
      break;
    }
  }
  return points;
}

// A pair of points that both frames show. An angle that is NaN says that no line runs through them.
struct Pair {
  std::string name;
  Point<2> fixed, moving;
  double fixed_angle = std::numeric_limits<double>::quiet_NaN();
  double moving_angle = std::numeric_limits<double>::quiet_NaN();
};

void add(Landmarks<2>& landmarks, const Pair& pair) {
  landmarks.names.push_back(pair.name);
  landmarks.fixed.push_back(pair.fixed);
  landmarks.moving.push_back(pair.moving);
  landmarks.fixed_angle.push_back(pair.fixed_angle);
  landmarks.moving_angle.push_back(pair.moving_angle);
}

// The angle of a line's direction, -pi/2 <= angle < pi/2.
double line_angle(double angle) {
  const double folded = std::remainder(angle, std::numbers::pi);
  return folded < kQuarter ? folded : folded - std::numbers::pi;
}

}  // namespace

double MammogramMap::carried_angle(const Point<2>& x, double angle_rad) const {
  Vector<2> direction =
      deformation.jacobian(x) * Vector<2>(std::cos(angle_rad), std::sin(angle_rad));
  if (mirrored) direction.x() = -direction.x();
  return std::atan2(direction.y(), direction.x());
}

void describe_fixed(const std::vector<Duct>& ducts, MammogramView view, MammogramImage& image) {
  image.outline = in_mm(skin_line(-kQuarter, kQuarter, kOutlinePoints));
  if (view == MammogramView::kMlo) image.pectoral = in_mm(pectoral_line(0, kPectoralPoints));
  image.nipple = kMammogramWidthMm * skin_point(kNippleAngle);
  image.marks = marks_in_mm(ducts);
}

void describe_moving(const std::vector<Duct>& ducts, MammogramView view, const MammogramMap& map,
                     MammogramImage& image) {
  constexpr double kBeyond = 0.5,
                   kBehind = 0.1;  // behind the chest wall, which the map may uncover
  constexpr int kFine = 32;
  const Box<2> frame = image.pixels.raster().bounds();
  image.outline = visible_part(
      in_mm(skin_line(-kQuarter - kBeyond, kQuarter + kBeyond, kOutlinePoints)), map, frame);
  if (view == MammogramView::kMlo) {
    const Polyline line = pectoral_line(-kBehind, kFine * kPectoralPoints);
    image.pectoral = visible_part(in_mm(line), map, frame);
  }
  image.nipple = map(kMammogramWidthMm * skin_point(kNippleAngle));
  for (DuctMark& mark : marks_in_mm(ducts)) {
    for (double& angle : mark.angles_rad) angle = map.carried_angle(mark.position, angle);
    mark.position = map(mark.position);
    if (frame.contains(mark.position)) image.marks.push_back(mark);
  }
}

Landmarks<2> mammogram_landmarks(const MammogramImage& fixed, const MammogramImage& moving,
                                 const MammogramMap& map) {
  const Box<2> frame = moving.pixels.raster().bounds();
  Landmarks<2> landmarks;
  const auto add_visible = [&](const Pair& pair) {
    if (frame.contains(pair.fixed) && frame.contains(pair.moving)) add(landmarks, pair);
  };
  int number = 0;
  for (const double theta : skin_angles_by_length(kContourPairs)) {
    const Point<2> x = kMammogramWidthMm * skin_point(theta);
    add_visible({message("contour ", ++number), x, map(x)});
  }
  add_visible({"nipple", fixed.nipple, moving.nipple});
  for (const DuctMark& mark : fixed.marks) {
    if (mark.crossing) continue;
    // Ducts that one breast alone has are numbered apart: equal names mean the same fork.
    const auto same = std::find_if(moving.marks.begin(), moving.marks.end(),
                                   [&](const auto& m) { return m.name == mark.name; });
    if (same == moving.marks.end()) continue;
    add_visible({mark.name, mark.position, same->position, line_angle(mark.angles_rad[0]),
                 line_angle(same->angles_rad[0])});
  }
  return landmarks;
}

std::vector<std::pair<std::string, double>> motion_parameters(const MammogramMotion& motion) {
  std::vector<std::pair<std::string, double>> list = {
      {"rotation_deg", motion.rotation_rad * 180 / std::numbers::pi},
      {"stretch_x", motion.stretch.x()},
      {"stretch_y", motion.stretch.y()},
      {"shear", motion.shear},
      {"center_x_mm", motion.center.x()},
      {"center_y_mm", motion.center.y()}};
  for (int axis = 0; axis < 2; ++axis) {
    for (std::size_t k = 0; k < motion.waves[axis].size(); ++k) {
      const auto& wave = motion.waves[axis][k];
      const std::string name = message("wave_", axis == 0 ? 'x' : 'y', k + 1, '_');
      list.insert(list.end(), {{name + "amplitude_mm", wave.amplitude_mm},
                               {name + "vector_x_rad_per_mm", wave.wave_vector.x()},
                               {name + "vector_y_rad_per_mm", wave.wave_vector.y()},
                               {name + "phase_rad", wave.phase_rad}});
    }
  }
  return list;
}

}  // namespace crease

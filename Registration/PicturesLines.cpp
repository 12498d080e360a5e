#include "Registration/PicturesLines.h"

#include <algorithm>
#include <cmath>

#include "Images/IntensityRange.h"
#include "Registration/PicturesCanvas.h"

namespace crease {

template <int Dim>
Picture dimmed_panel(const Image<float, Dim>& image, const Slice<Dim>& slice) {
  constexpr double kDimmed = 0.85, kGamma = 0.75;
  const IntensityRange window = intensity_percentiles(image);
  const Image<float, 2> plane = pixels(image, slice);
  Picture picture = canvas::blank(slice.width, slice.height, canvas::kPaper);
  for (int y = 0; y < slice.height; ++y) {
    for (int x = 0; x < slice.width; ++x) {
      const double t = window.constant() ? 0.5 : (plane(x, y) - window.lower) / window.width();
      const auto g = static_cast<std::uint8_t>(
          std::lround(255 * kDimmed * std::pow(std::clamp(t, 0.0, 1.0), kGamma)));
      canvas::set_pixel(picture, x, y, {g, g, g});
    }
  }
  return picture;
}

template <int Dim>
std::vector<std::vector<Point<Dim>>> grid_lines(const Raster<Dim>& raster, const Slice<Dim>& slice,
                                                int count, double depth) {
  double longest = 0;
  for (int a = 0; a < Dim; ++a) longest = std::max(longest, raster.size[a] * raster.spacing[a]);
  const double step_mm = longest / count;
  std::vector<std::vector<Point<Dim>>> lines;
  for (const auto& [along, across] :
       {std::pair(slice.first, slice.second), std::pair(slice.second, slice.first)}) {
    const double step = step_mm / raster.spacing[across];
    const int cells = std::max(1, static_cast<int>(raster.size[across] / step + 1e-6));
    const double first = 0.5 * (raster.size[across] - cells * step) - 0.5;
    for (int k = 0; k <= cells; ++k) {
      Vector<Dim> start = Vector<Dim>::Constant(depth), end = start;
      start[across] = end[across] = first + k * step;
      start[along] = -0.5;
      end[along] = raster.size[along] - 0.5;
      lines.push_back({raster.point(start), raster.point(end)});
    }
  }
  return lines;
}

template <int Dim>
std::vector<std::vector<Point<2>>> mapped_line(const Slice<Dim>& slice, const Raster<Dim>& moving,
                                               const PointMap<Dim>& map,
                                               const std::vector<Point<Dim>>& line, double step) {
  std::vector<std::vector<Point<2>>> parts(1);
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector<Dim> edge = line[i + 1] - line[i];
    const double length = (moving.point_to_index() * edge).norm() * slice.scale.maxCoeff();
    const int pieces = std::max(1, static_cast<int>(std::ceil(length / step)));
    for (int k = i == 0 ? 0 : 1; k <= pieces; ++k) {
      const Point<Dim> y = map(line[i] + edge * (double(k) / pieces));
      if (y.allFinite()) {
        parts.back().push_back(slice.pixel(moving.index(y)));
      } else if (!parts.back().empty()) {
        parts.emplace_back();
      }
    }
  }
  std::erase_if(parts, [](const auto& part) { return part.size() < 2; });
  return parts;
}

Polyline closed_points(const FeatureLine& line) {
  Polyline points = line.points;
  if (line.closed) points.push_back(points.front());
  return points;
}

template Picture dimmed_panel<2>(const Image<float, 2>&, const Slice<2>&);
template Picture dimmed_panel<3>(const Image<float, 3>&, const Slice<3>&);
template std::vector<std::vector<Point<2>>> grid_lines<2>(const Raster<2>&, const Slice<2>&, int,
                                                          double);
template std::vector<std::vector<Point<3>>> grid_lines<3>(const Raster<3>&, const Slice<3>&, int,
                                                          double);
template std::vector<std::vector<Point<2>>> mapped_line<2>(const Slice<2>&, const Raster<2>&,
                                                           const PointMap<2>&,
                                                           const std::vector<Point<2>>&, double);
template std::vector<std::vector<Point<2>>> mapped_line<3>(const Slice<3>&, const Raster<3>&,
                                                           const PointMap<3>&,
                                                           const std::vector<Point<3>>&, double);

}  // namespace crease

#include <algorithm>
#include <cmath>
#include <set>

#include "Images/IntensityRange.h"
#include "Registration/Pictures.h"
#include "Registration/PicturesCanvas.h"
#include "Registration/PicturesSlices.h"

namespace crease {
namespace {

using canvas::Colour;

constexpr Colour kGrid{70, 190, 230}, kMesh{95, 205, 190}, kFeature{255, 140, 0},
    kLandmark{255, 60, 170};
constexpr double kDimmed = 0.85, kGamma = 0.75;  // grey levels of the image below the lines

// Maps a line of the fixed image into the picture, in pieces of about 4 pixels; where the map has
// no value the line is broken.
template <int Dim>
void draw_mapped(Picture& picture, const Slice<Dim>& slice, const Raster<Dim>& moving,
                 const PointMap<Dim>& map, const std::vector<Point<Dim>>& line, Colour colour,
                 int width) {
  std::vector<Point<2>> drawn;
  const auto flush = [&] {
    if (drawn.size() > 1) canvas::draw_polyline(picture, drawn, false, colour, width);
    drawn.clear();
  };
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector<Dim> edge = line[i + 1] - line[i];
    const double length = (moving.point_to_index() * edge).norm() * slice.scale.maxCoeff();
    const int pieces = std::max(1, static_cast<int>(std::ceil(length / 4)));
    for (int k = i == 0 ? 0 : 1; k <= pieces; ++k) {
      const Point<Dim> y = map(line[i] + edge * (double(k) / pieces));
      if (y.allFinite()) {
        drawn.push_back(slice.pixel(moving.index(y)));
      } else {
        flush();
      }
    }
  }
  flush();
}

// Lines of constant index along both axes of the slice, through the middle of the fixed raster.
template <int Dim>
std::vector<std::vector<Point<Dim>>> grid_lines(const Raster<Dim>& raster, const Slice<Dim>& slice,
                                                int count) {
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
      Vector<Dim> start, end;
      for (int a = 0; a < Dim; ++a) start[a] = end[a] = 0.5 * (raster.size[a] - 1);
      start[across] = end[across] = first + k * step;
      start[along] = -0.5;
      end[along] = raster.size[along] - 0.5;
      lines.push_back({raster.point(start), raster.point(end)});
    }
  }
  return lines;
}

std::vector<std::vector<Point<2>>> mesh_edges(const SimplexMesh<2>& mesh) {
  std::set<std::pair<int, int>> edges;
  for (const auto& triangle : mesh.simplices) {
    for (int k = 0; k < 3; ++k) {
      edges.insert(std::minmax({triangle[k], triangle[(k + 1) % 3]}));
    }
  }
  std::vector<std::vector<Point<2>>> lines;
  for (const auto& [a, b] : edges) lines.push_back({mesh.vertices[a], mesh.vertices[b]});
  return lines;
}

std::vector<Point<2>> closed_points(const FeatureLine& line) {
  std::vector<Point<2>> points = line.points;
  if (line.closed) points.push_back(points.front());
  return points;
}

template <int Dim>
Picture dimmed_panel(const Image<float, Dim>& image, const Slice<Dim>& slice) {
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
void draw_landmarks(Picture& picture, const Slice<Dim>& slice, const Raster<Dim>& moving,
                    const DeformationDrawing<Dim>& drawing) {
  for (int j = 0; j < drawing.landmarks.size(); ++j) {
    const Point<Dim> mapped = drawing.map(drawing.landmarks.fixed[j]);
    const Point<2> ring = slice.pixel(moving.index(drawing.landmarks.moving[j]));
    canvas::draw_ring(picture, ring, 7, kLandmark, 2);
    if (mapped.allFinite()) {
      canvas::draw_cross(picture, slice.pixel(moving.index(mapped)), 4, kLandmark, 1);
    }
  }
}

}  // namespace

template <int Dim>
Picture deformation_picture(const Image<float, Dim>& moving,
                            const DeformationDrawing<Dim>& drawing) {
  std::vector<std::pair<std::string, Picture>> panels;
  canvas::Legend legend;
  if (drawing.mesh) {
    legend.swatches.emplace_back(kMesh, "mesh");
  } else if (drawing.grid_lines > 0) {
    legend.swatches.emplace_back(kGrid, "grid");
  }
  if (!drawing.feature_lines.empty()) legend.swatches.emplace_back(kFeature, "crease");
  if (!drawing.landmarks.empty()) legend.swatches.emplace_back(kLandmark, "landmark");
  for (const auto& slice : slices(moving.raster())) {
    Picture picture = dimmed_panel(moving, slice);
    const auto draw = [&](const std::vector<Point<Dim>>& line, Colour colour, int width) {
      draw_mapped(picture, slice, moving.raster(), drawing.map, line, colour, width);
    };
    if constexpr (Dim == 2) {
      if (drawing.mesh) {
        for (const auto& edge : mesh_edges(*drawing.mesh)) draw(edge, kMesh, 1);
      }
    }
    if (!drawing.mesh && drawing.grid_lines > 0) {
      for (const auto& line : grid_lines(drawing.fixed_raster, slice, drawing.grid_lines)) {
        draw(line, kGrid, 1);
      }
    }
    if constexpr (Dim == 2) {
      for (const auto& line : drawing.feature_lines) draw(closed_points(line), kFeature, 2);
    }
    draw_landmarks(picture, slice, moving.raster(), drawing);
    const std::string title = "Fixed grid mapped onto the moving image";
    panels.emplace_back(slice.name.empty() ? title : slice.name, std::move(picture));
  }
  return canvas::framed(panels, legend, {});
}

template Picture deformation_picture<2>(const Image<float, 2>&, const DeformationDrawing<2>&);
template Picture deformation_picture<3>(const Image<float, 3>&, const DeformationDrawing<3>&);

}  // namespace crease

#include <algorithm>
#include <set>

#include "Registration/Pictures.h"
#include "Registration/PicturesCanvas.h"
#include "Registration/PicturesLines.h"
#include "Registration/PicturesSlices.h"

namespace crease {
namespace {

using canvas::Colour;

constexpr Colour kGrid{70, 190, 230}, kMesh{95, 205, 190}, kFeature{255, 140, 0},
    kLandmark{255, 60, 170};

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
      for (const auto& part : mapped_line(slice, moving.raster(), drawing.map, line)) {
        canvas::draw_polyline(picture, part, false, colour, width);
      }
    };
    if constexpr (Dim == 2) {
      if (drawing.mesh) {
        for (const auto& edge : mesh_edges(*drawing.mesh)) draw(edge, kMesh, 1);
      }
    }
    if (!drawing.mesh && drawing.grid_lines > 0) {
      const int across = Dim == 2 ? 0 : 3 - slice.first - slice.second;
      const double depth = 0.5 * (drawing.fixed_raster.size[across] - 1);
      for (const auto& line : grid_lines(drawing.fixed_raster, slice, drawing.grid_lines, depth)) {
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

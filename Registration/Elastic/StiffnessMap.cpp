#include "Registration/Elastic/StiffnessMap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "Core/Parallel.h"
#include "Registration/PicturesSlices.h"
#include "Transforms/Splines/KnotLocator.h"

namespace crease {
namespace {

constexpr canvas::Colour kOutside{200, 200, 200};
constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kMostTicks = 6;

/// Of a sample that is read between pixels, the pixel's own: tissues are not mixed.
float nearest(const Image<float, 2>& image, const Slice<2>& slice, int x, int y) {
  const auto index = [](double at, int size) {
    return std::clamp(static_cast<int>(std::lround(at)), 0, size - 1);
  };
  return image(index((x + 0.5) / slice.scale.x() - 0.5, image.size()[0]),
               index((y + 0.5) / slice.scale.y() - 0.5, image.size()[1]));
}

}  // namespace

Image<float, 2> stiffness_map(const CreasedDomain& domain, const ElasticMaterial& material,
                              const Raster<2>& raster) {
  Image<float, 2> map(raster, kNoValue);
  const SimplexMesh<2>& mesh = domain.mesh.mesh;
  const KnotLocator<2> locator(mesh, kKnotTie * mesh_scale(mesh));
  const Vector<2> step = raster.index_to_point().col(0);
  parallel_for(raster.num_rows(), [&](std::int64_t r) {
    const auto row = map.row(r);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const int t = locator.find(raster.row_start(r) + static_cast<double>(i) * step);
      if (t >= 0) row[i] = static_cast<float>(material.of(mesh.region(t)).young);
    }
  });
  return map;
}

ColourScale stiffness_scale(const Image<float, 2>& stiffness) {
  std::set<float> tissues;
  for (float young : stiffness.values()) {
    if (std::isfinite(young)) tissues.insert(young);
  }
  constexpr double kSpread = 1.5;  // beyond the softest and the stiffest
  ColourScale scale{.lower = *tissues.begin() / kSpread,
                    .upper = *tissues.rbegin() * kSpread,
                    .logarithmic = true};
  for (float young : tissues) {
    if (scale.ticks.size() == kMostTicks) break;
    const double value = young;
    scale.ticks.emplace_back(scale.position(value), short_number(value));
  }
  return scale;
}

Picture stiffness_picture(const Image<float, 2>& stiffness) {
  const ColourScale scale = stiffness_scale(stiffness);
  std::vector<std::pair<std::string, Picture>> panels;
  for (const Slice<2>& slice : slices(stiffness.raster())) {
    Picture picture = canvas::blank(slice.width, slice.height, kOutside);
    for (int y = 0; y < slice.height; ++y) {
      for (int x = 0; x < slice.width; ++x) {
        const float young = nearest(stiffness, slice, x, y);
        if (!std::isfinite(young)) continue;
        canvas::set_pixel(picture, x, y, scale.colour(scale.position(static_cast<double>(young))));
      }
    }
    panels.emplace_back("Young's modulus E", std::move(picture));
  }
  canvas::Legend legend;
  legend.colour = scale.colour;
  legend.ticks = scale.ticks;
  legend.swatches.emplace_back(kOutside, "outside");
  return canvas::framed(panels, legend, {});
}

}  // namespace crease

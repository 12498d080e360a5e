#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "Core/Parallel.h"
#include "Core/Raster.h"
#include "Transforms/TransformSampler.h"

namespace crease {

/// The points of a row.
template <int Dim>
std::vector<Point<Dim>> row_points(const Raster<Dim>& raster, std::int64_t row) {
  const Point<Dim> start = raster.row_start(row);
  const Vector<Dim> step = raster.index_to_point().col(0);
  std::vector<Point<Dim>> points(static_cast<std::size_t>(raster.size[0]));
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = start + static_cast<double>(i) * step;
  return points;
}

/// Calls body(row, points, samples) for every row of a raster, with a transform's samples there. In parallel.
template <int Dim, typename Body>
void for_each_row(const Transform<Dim>& transform, const Raster<Dim>& raster, const Body& body) {
  const auto sampler = transform.sampler();
  parallel_for(raster.num_rows(), [&](std::int64_t row) {
    const std::vector<Point<Dim>> points = row_points(raster, row);
    std::vector<typename Transform<Dim>::Sample> samples(points.size());
    sampler->sample(points, samples);
    body(row, std::span<const Point<Dim>>(points),
         std::span<const typename Transform<Dim>::Sample>(samples));
  });
}

}  // namespace crease

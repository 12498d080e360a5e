#include "Registration/SamplesInside.h"

#include <array>
#include <cstdint>

#include "Core/Parallel.h"
#include "Registration/RowTiles.h"

namespace crease {
namespace {

/// Weights of one row; displacement[a][i] may be null.
template <int Dim>
void keep_row(const Raster<Dim>& fixed, const AffineMap<Dim>& affine, const Raster<Dim>& moving,
              std::int64_t r, const std::array<const float*, Dim>& displacement, double margin,
              float* weights) {
  const Matrix<Dim> to_index = moving.point_to_index();
  const Vector<Dim> first = to_index * (affine(fixed.row_start(r)) - moving.origin);
  const Vector<Dim> step = to_index * (affine.linear * fixed.index_to_point().col(0));
  for (int i = 0; i < fixed.size[0]; ++i) {
    if (weights[i] == 0) continue;
    Vector<Dim> index = first + i * step;
    if (displacement[0] != nullptr) {
      Vector<Dim> u;
      for (int a = 0; a < Dim; ++a) u[a] = static_cast<double>(displacement[a][i]);
      index += to_index * u;
    }
    for (int a = 0; a < Dim; ++a) {
      if (!(index[a] >= margin && index[a] <= moving.size[a] - 1 - margin)) weights[i] = 0;
    }
  }
}

}  // namespace

template <int Dim>
void keep_samples_inside(const BoundGrid<Dim>& grid, const AffineMap<Dim>& affine,
                         const Eigen::Ref<const ControlPoints<Dim>>& phi, const Raster<Dim>& moving,
                         double margin, std::vector<float>& weights) {
  const Raster<Dim>& fixed = grid.raster();
  const RowTiles<Dim> tiles(fixed);
  const auto coefficients = grid.prepare(phi);
  parallel_for(tiles.count(), [&](std::int64_t tile) {
    std::array<std::vector<float>, Dim> rows;
    std::array<float*, Dim> out;
    std::array<const float*, Dim> displacement;
    for (int a = 0; a < Dim; ++a) {
      rows[a].resize(padded_row_size(fixed));
      out[a] = rows[a].data();
      displacement[a] = rows[a].data();
    }
    tiles.for_each_row(tile, [&](std::int64_t r) {
      grid.map_row(*coefficients, r, out);
      keep_row<Dim>(fixed, affine, moving, r, displacement, margin,
                    weights.data() + r * fixed.size[0]);
    });
  });
}

template <int Dim>
void keep_samples_inside(const Raster<Dim>& fixed, const AffineMap<Dim>& affine,
                         const Raster<Dim>& moving, double margin, std::vector<float>& weights) {
  parallel_for(fixed.num_rows(), [&](std::int64_t r) {
    keep_row<Dim>(fixed, affine, moving, r, {}, margin, weights.data() + r * fixed.size[0]);
  });
}

template <int Dim>
void keep_samples_in_domain(const BoundGrid<Dim>& grid, std::vector<float>& weights) {
  const auto width = static_cast<std::size_t>(grid.raster().size[0]);
  std::vector<std::uint8_t> inside(width);
  for (std::int64_t r = 0; r < grid.raster().num_rows(); ++r) {
    grid.coverage(r, inside);
    float* row = weights.data() + static_cast<std::size_t>(r) * width;
    for (std::size_t i = 0; i < width; ++i) row[i] *= static_cast<float>(inside[i]);
  }
}

template void keep_samples_inside<2>(const BoundGrid<2>&, const AffineMap<2>&,
                                     const Eigen::Ref<const ControlPoints<2>>&, const Raster<2>&,
                                     double, std::vector<float>&);
template void keep_samples_inside<3>(const BoundGrid<3>&, const AffineMap<3>&,
                                     const Eigen::Ref<const ControlPoints<3>>&, const Raster<3>&,
                                     double, std::vector<float>&);
template void keep_samples_inside<2>(const Raster<2>&, const AffineMap<2>&, const Raster<2>&,
                                     double, std::vector<float>&);
template void keep_samples_inside<3>(const Raster<3>&, const AffineMap<3>&, const Raster<3>&,
                                     double, std::vector<float>&);

template void keep_samples_in_domain<2>(const BoundGrid<2>&, std::vector<float>&);
template void keep_samples_in_domain<3>(const BoundGrid<3>&, std::vector<float>&);

}  // namespace crease

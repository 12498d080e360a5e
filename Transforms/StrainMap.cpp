#include "Transforms/StrainMap.h"

#include "Core/Parallel.h"

namespace crease {

template <int Dim>
std::vector<double> strain_map(const Transform<Dim>& transform, const Raster<Dim>& raster) {
  std::vector<double> strain(static_cast<std::size_t>(raster.num_samples()));
  const Vector<Dim> step = raster.index_to_point().col(0);
  parallel_for(raster.num_rows(), [&](std::int64_t row) {
    const Point<Dim> start = raster.row_start(row);
    for (int i = 0; i < raster.size[0]; ++i) {
      strain[static_cast<std::size_t>(row * raster.size[0] + i)] =
          strain_norm<Dim>(transform.spatial_jacobian(start + i * step));
    }
  });
  return strain;
}

template std::vector<double> strain_map(const Transform<2>&, const Raster<2>&);
template std::vector<double> strain_map(const Transform<3>&, const Raster<3>&);

}  // namespace crease

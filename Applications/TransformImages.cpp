#include "Applications/TransformImages.h"

#include <Eigen/LU>

#include "Core/Parallel.h"
#include "Transforms/StrainMap.h"

namespace crease {

template <int Dim>
TransformImages<Dim> transform_images(const Transform<Dim>& transform, const Raster<Dim>& raster) {
  TransformImages<Dim> images{DisplacementField<Dim>(raster), Image<float, Dim>(raster),
                              Image<float, Dim>(raster), Mask<Dim>(raster)};
  const Vector<Dim> step = raster.index_to_point().col(0);
  parallel_for(raster.num_rows(), [&](std::int64_t row) {
    const Point<Dim> start = raster.row_start(row);
    const auto displacement = images.displacement.row(row);
    const auto determinants = images.determinants.row(row), strain = images.strain.row(row);
    const auto domain = images.domain.row(row);
    for (std::size_t i = 0; i < displacement.size(); ++i) {
      const Point<Dim> x = start + static_cast<double>(i) * step;
      const auto sample = transform.sample(x);
      displacement[i] = sample.point - x;
      determinants[i] = static_cast<float>(sample.jacobian.determinant());
      strain[i] = static_cast<float>(strain_norm<Dim>(sample.jacobian));
      domain[i] = sample.in_domain ? 1 : 0;
    }
  });
  return images;
}

template TransformImages<2> transform_images<2>(const Transform<2>&, const Raster<2>&);
template TransformImages<3> transform_images<3>(const Transform<3>&, const Raster<3>&);

}  // namespace crease

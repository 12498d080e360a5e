#include "Applications/TransformImages.h"

#include <Eigen/LU>

#include "Transforms/StrainMap.h"
#include "Transforms/TransformRows.h"

namespace crease {

template <int Dim>
TransformImages<Dim> transform_images(const Transform<Dim>& transform, const Raster<Dim>& raster) {
  TransformImages<Dim> images{DisplacementField<Dim>(raster), Image<float, Dim>(raster),
                              Image<float, Dim>(raster), Mask<Dim>(raster)};
  for_each_row(transform, raster, [&](std::int64_t row, const auto& x, const auto& samples) {
    const auto displacement = images.displacement.row(row);
    const auto determinants = images.determinants.row(row), strain = images.strain.row(row);
    const auto domain = images.domain.row(row);
    for (std::size_t i = 0; i < displacement.size(); ++i) {
      displacement[i] = samples[i].point - x[i];
      determinants[i] = static_cast<float>(samples[i].jacobian.determinant());
      strain[i] = static_cast<float>(strain_norm<Dim>(samples[i].jacobian));
      domain[i] = samples[i].in_domain ? 1 : 0;
    }
  });
  return images;
}

template TransformImages<2> transform_images<2>(const Transform<2>&, const Raster<2>&);
template TransformImages<3> transform_images<3>(const Transform<3>&, const Raster<3>&);

}  // namespace crease

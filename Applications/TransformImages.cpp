#include "Applications/TransformImages.h"

#include <algorithm>

#include "Transforms/JacobianMap.h"

namespace crease {

template <int Dim>
TransformImages<Dim> transform_images(const Transform<Dim>& transform, const Raster<Dim>& raster) {
  ControlPoints<Dim> displacement;
  std::vector<double> strain;
  const JacobianMap<Dim> map = jacobian_map(transform, raster, &displacement, &strain);
  TransformImages<Dim> images{DisplacementField<Dim>(raster), Image<float, Dim>(raster),
                              Image<float, Dim>(raster), Mask<Dim>(raster, map.in_domain)};
  for (Eigen::Index i = 0; i < displacement.cols(); ++i) {
    images.displacement.values()[static_cast<std::size_t>(i)] = displacement.col(i);
  }
  const auto narrow = [](double value) { return static_cast<float>(value); };
  std::ranges::transform(map.determinants, images.determinants.values().begin(), narrow);
  std::ranges::transform(strain, images.strain.values().begin(), narrow);
  return images;
}

template TransformImages<2> transform_images<2>(const Transform<2>&, const Raster<2>&);
template TransformImages<3> transform_images<3>(const Transform<3>&, const Raster<3>&);

}  // namespace crease

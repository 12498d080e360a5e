#include "Applications/TransformImages.h"

#include <algorithm>

#include "Transforms/DisplacementField.h"

namespace crease {

template <int Dim>
DisplacementField<Dim> displacement_image(const Transform<Dim>& transform,
                                          const Raster<Dim>& raster) {
  const ControlPoints<Dim> columns = displacement_field(transform, raster);
  DisplacementField<Dim> field(raster);
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    field.values()[static_cast<std::size_t>(i)] = columns.col(i);
  }
  return field;
}

template <int Dim>
Image<float, Dim> determinant_image(const JacobianMap<Dim>& map) {
  Image<float, Dim> image(map.raster);
  std::ranges::transform(map.determinants, image.values().begin(),
                         [](double value) { return static_cast<float>(value); });
  return image;
}

template DisplacementField<2> displacement_image<2>(const Transform<2>&, const Raster<2>&);
template DisplacementField<3> displacement_image<3>(const Transform<3>&, const Raster<3>&);
template Image<float, 2> determinant_image<2>(const JacobianMap<2>&);
template Image<float, 3> determinant_image<3>(const JacobianMap<3>&);

}  // namespace crease

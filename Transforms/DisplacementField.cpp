#include "Transforms/DisplacementField.h"

#include "Transforms/TransformRows.h"

namespace crease {

template <int Dim>
ControlPoints<Dim> displacement_field(const Transform<Dim>& transform, const Raster<Dim>& raster) {
  ControlPoints<Dim> field(Dim, raster.num_samples());
  for_each_row(transform, raster, [&](std::int64_t row, const auto& x, const auto& samples) {
    const std::int64_t first = row * raster.size[0];
    for (std::size_t i = 0; i < x.size(); ++i) {
      field.col(first + static_cast<std::int64_t>(i)) = samples[i].point - x[i];
    }
  });
  return field;
}

template ControlPoints<2> displacement_field(const Transform<2>&, const Raster<2>&);
template ControlPoints<3> displacement_field(const Transform<3>&, const Raster<3>&);

}  // namespace crease

#include "Transforms/DisplacementField.h"

#include "Transforms/TransformRows.h"

namespace crease {

template <int Dim>
ControlPoints<Dim> displacement_field(const Transform<Dim>& transform, const Raster<Dim>& raster) {
  ControlPoints<Dim> field(Dim, raster.num_samples());
  const auto sampler = transform.sampler();
  parallel_for(raster.num_rows(), [&](std::int64_t row) {
    const std::vector<Point<Dim>> x = row_points(raster, row);
    std::vector<Point<Dim>> y(x.size());
    sampler->map(x, y);
    const std::int64_t first = row * raster.size[0];
    for (std::size_t i = 0; i < x.size(); ++i) {
      field.col(first + static_cast<std::int64_t>(i)) = y[i] - x[i];
    }
  });
  return field;
}

template ControlPoints<2> displacement_field(const Transform<2>&, const Raster<2>&);
template ControlPoints<3> displacement_field(const Transform<3>&, const Raster<3>&);

}  // namespace crease

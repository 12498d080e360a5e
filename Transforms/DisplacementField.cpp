#include "Transforms/DisplacementField.h"

#include "Core/Parallel.h"

namespace crease {

template <int Dim>
ControlPoints<Dim> displacement_field(const Transform<Dim>& transform, const Raster<Dim>& raster) {
  ControlPoints<Dim> field(Dim, raster.num_samples());
  const Vector<Dim> step = raster.index_to_point().col(0);
  parallel_for(raster.num_rows(), [&](std::int64_t row) {
    const Point<Dim> start = raster.row_start(row);
    for (int i = 0; i < raster.size[0]; ++i) {
      const Point<Dim> x = start + i * step;
      field.col(row * raster.size[0] + i) = transform.map(x) - x;
    }
  });
  return field;
}

template ControlPoints<2> displacement_field(const Transform<2>&, const Raster<2>&);
template ControlPoints<3> displacement_field(const Transform<3>&, const Raster<3>&);

}  // namespace crease

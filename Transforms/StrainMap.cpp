#include "Transforms/StrainMap.h"

#include "Transforms/TransformRows.h"

namespace crease {

template <int Dim>
std::vector<double> strain_map(const Transform<Dim>& transform, const Raster<Dim>& raster) {
  std::vector<double> strain(static_cast<std::size_t>(raster.num_samples()));
  for_each_row(transform, raster, [&](std::int64_t row, const auto&, const auto& samples) {
    const auto first = static_cast<std::size_t>(row * raster.size[0]);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      strain[first + i] = strain_norm<Dim>(samples[i].jacobian);
    }
  });
  return strain;
}

template std::vector<double> strain_map(const Transform<2>&, const Raster<2>&);
template std::vector<double> strain_map(const Transform<3>&, const Raster<3>&);

}  // namespace crease

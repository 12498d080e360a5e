#include "Transforms/JacobianMap.h"

#include <Eigen/LU>

#include "Core/Error.h"
#include "Transforms/TransformRows.h"

namespace crease {

template <int Dim>
JacobianStatistics<Dim> JacobianMap<Dim>::statistics(std::span<const std::uint8_t> mask) const {
  if (!mask.empty() && mask.size() != determinants.size()) {
    throw InvalidInput(message("JacobianMap: the mask has ", mask.size(), " samples, the map ",
                               determinants.size(), "."));
  }
  JacobianStatistics<Dim> result;
  std::size_t smallest = 0;
  double sum = 0;
  for (std::size_t n = 0; n < determinants.size(); ++n) {
    if (!in_domain[n] || (!mask.empty() && mask[n] == 0)) continue;
    const double det = determinants[n];
    if (result.num_samples == 0 || det < result.minimum) {
      result.minimum = det;
      smallest = n;
    }
    result.maximum = result.num_samples == 0 ? det : std::max(result.maximum, det);
    ++result.num_samples;
    result.num_folded += !(det > 0);
    sum += det;
  }
  if (result.num_samples == 0) return result;
  result.mean = sum / static_cast<double>(result.num_samples);
  result.folded_measure = static_cast<double>(result.num_folded) * raster.sample_volume();
  const auto row = static_cast<std::int64_t>(smallest) / raster.size[0];
  const auto i = static_cast<std::int64_t>(smallest) % raster.size[0];
  result.minimum_at =
      raster.row_start(row) + static_cast<double>(i) * raster.index_to_point().col(0);
  return result;
}

template <int Dim>
JacobianMap<Dim> jacobian_map(const Transform<Dim>& transform, const Raster<Dim>& raster) {
  JacobianMap<Dim> result{raster, {}, {}};
  result.determinants.resize(static_cast<std::size_t>(raster.num_samples()));
  result.in_domain.resize(result.determinants.size());
  for_each_row(transform, raster, [&](std::int64_t row, const auto&, const auto& samples) {
    const auto first = static_cast<std::size_t>(row * raster.size[0]);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      result.determinants[first + i] = samples[i].jacobian.determinant();
      result.in_domain[first + i] = samples[i].in_domain ? 1 : 0;
    }
  });
  return result;
}

template struct JacobianMap<2>;
template struct JacobianMap<3>;
template JacobianMap<2> jacobian_map(const Transform<2>&, const Raster<2>&);
template JacobianMap<3> jacobian_map(const Transform<3>&, const Raster<3>&);

}  // namespace crease

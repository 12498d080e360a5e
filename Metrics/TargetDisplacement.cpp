#include "Metrics/TargetDisplacement.h"

#include <cmath>

#include "Core/Error.h"
#include "Core/Parallel.h"

namespace crease {
namespace {

/// Where component a stands on the diagonal of (xx, xy, yy) or (xx, xy, xz, yy, yz, zz).
constexpr int diagonal_entry(int a, int dim) { return a * dim - a * (a - 1) / 2; }

bool all_finite(const std::vector<float>& values) {
  for (float v : values) {
    if (!std::isfinite(v)) return false;
  }
  return true;
}

}  // namespace

template <int Dim>
TargetDisplacement<Dim>::TargetDisplacement(const Raster<Dim>& raster,
                                            std::array<std::vector<float>, Dim> field,
                                            std::vector<float> weights)
    : raster_(raster), field_(std::move(field)), weights_(std::move(weights)) {
  const auto count = static_cast<std::size_t>(raster.num_samples());
  bool valid = weights_.size() == count && all_finite(weights_);
  for (const auto& component : field_) {
    valid = valid && component.size() == count && all_finite(component);
  }
  if (!valid) {
    throw InvalidInput(message("target displacement: the field and its weights must have ", count,
                               " finite entries each, one per sample"));
  }
}

template <int Dim>
void TargetDisplacement<Dim>::evaluate_row(int, const MappedRow<Dim>& row, const ForceRow<Dim>& out,
                                           typename Metric<Dim>::Sums& sums) const {
  const std::int64_t offset = row.row * raster_.size[0];
  const Point<Dim> from = raster_.row_start(row.row);
  const Vector<Dim> step = raster_.index_to_point().col(0);
  const double volume = raster_.sample_volume();
  double value = 0, weight = 0;
  for (int i = row.begin; i < row.end; ++i) {
    const double w = weights_[static_cast<std::size_t>(offset + i)];
    for (int a = 0; a < Dim; ++a) {
      const double u = row.displacement[a] == nullptr ? 0.0 : row.displacement[a][i];
      const double difference = row.start[a] - from[a] + i * (row.step[a] - step[a]) + u -
                                field_[a][static_cast<std::size_t>(offset + i)];
      value += 0.5 * w * difference * difference;
      if (out.force[a] != nullptr) out.force[a][i] = static_cast<float>(w * volume * difference);
      if (out.curvature[0] != nullptr) {
        out.curvature[diagonal_entry(a, Dim)][i / 4] += static_cast<float>(w * volume);
      }
    }
    weight += w;
  }
  sums.value += volume * value;
  sums.weight += weight;
}

template <int Dim>
double TargetDisplacement<Dim>::finish_pass(
    int, std::span<const std::unique_ptr<typename Metric<Dim>::Sums>> tiles) {
  double value = 0;
  for (const auto& tile : tiles) value += tile->value;
  return value;
}

template <int Dim>
double TargetDisplacement<Dim>::evaluate(std::span<const Point<Dim>> mapped,
                                         std::span<Vector<Dim>> forces) const {
  if (mapped.size() != weights_.size() || (!forces.empty() && forces.size() != weights_.size())) {
    throw InvalidInput(message("target displacement: ", mapped.size(), " mapped points for ",
                               weights_.size(), " samples"));
  }
  const double volume = raster_.sample_volume();
  return parallel_sum(
      raster_.num_rows(), 0.0,
      [&](std::int64_t r, double& sum) {
        const Point<Dim> from = raster_.row_start(r);
        const Vector<Dim> step = raster_.index_to_point().col(0);
        for (int i = 0; i < raster_.size[0]; ++i) {
          const auto k = static_cast<std::size_t>(r * raster_.size[0] + i);
          Vector<Dim> difference = mapped[k] - from - i * step;
          for (int a = 0; a < Dim; ++a) difference[a] -= static_cast<double>(field_[a][k]);
          const double w = weights_[k] * volume;
          sum += 0.5 * w * difference.squaredNorm();
          if (!forces.empty()) forces[k] = w * difference;
        }
      },
      16);
}

template class TargetDisplacement<2>;
template class TargetDisplacement<3>;

}  // namespace crease

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "Core/Raster.h"
#include "Transforms/Transform.h"

namespace crease {

/// How a map changes area or volume over some samples, and where it folds.
template <int Dim>
struct JacobianStatistics {
  std::int64_t num_samples = 0;  ///< samples that count
  std::int64_t num_folded = 0;   ///< of these, with det grad T <= 0
  double folded_measure = 0;     ///< their area (mm^2) or volume (mm^3)
  double minimum = 0;            ///< 0 when no sample counts, like the two below
  double maximum = 0;
  double mean = 0;
  Point<Dim> minimum_at = Point<Dim>::Zero();  ///< mm
};

/// det grad T at every sample of a raster, exactly from the transform's formula.
template <int Dim>
struct JacobianMap {
  Raster<Dim> raster;
  std::vector<double> determinants;     ///< outside the domain those of T's continuation
  std::vector<std::uint8_t> in_domain;  ///< 1 or 0 per sample
  /// Over the samples of the domain where `mask` (empty: everywhere) is not 0.
  JacobianStatistics<Dim> statistics(std::span<const std::uint8_t> mask = {}) const;
};

/// In parallel, the same on any number of threads.
template <int Dim>
JacobianMap<Dim> jacobian_map(const Transform<Dim>& transform, const Raster<Dim>& raster);

extern template struct JacobianMap<2>;
extern template struct JacobianMap<3>;

}  // namespace crease

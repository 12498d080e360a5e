#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "Core/Error.h"
#include "Images/Image.h"
#include "Images/Interpolator.h"

namespace crease {

/// The two images of one resolution level, as every metric takes them.
template <int Dim>
struct MetricInput {
  Image<float, Dim> fixed;
  /// One weight >= 0 per sample of the fixed image (mask times domain); 0: the sample does not count.
  std::vector<float> weights;
  std::shared_ptr<const Interpolator<Dim>> moving;
  /// Weight in [0, 1] of points of the moving image; null: 1 everywhere.
  std::shared_ptr<const Interpolator<Dim>> moving_mask;
  /// Of the moving image's coefficients where it counts; nullopt: of all of them.
  std::optional<IntensityRange> moving_range = std::nullopt;
};

/// @throws InvalidInput when sizes do not match, weights are negative or not finite, all weights are
/// zero, or the fixed image is constant where it counts.
template <int Dim>
void check(const MetricInput<Dim>& input);

/// Too few samples fall inside the moving image.
class OverlapError : public SolverError {
 public:
  using SolverError::SolverError;
};

/// @throws OverlapError when fewer than a quarter of the samples fall inside the moving image.
void check_overlap(const char* metric, double weight_inside, double weight);

extern template void check<2>(const MetricInput<2>&);
extern template void check<3>(const MetricInput<3>&);

}  // namespace crease

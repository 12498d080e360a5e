#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "Core/Point.h"

namespace crease {

/// u(x) = sum_i phi_i B_i(x) for control points that stay as they are, prepared for many points of which
/// neighbours in the list lie near each other. Thread-safe.
template <int Dim>
class SplineSampler {
 public:
  virtual ~SplineSampler() = default;
  /// Column k: u at x[k], then du/dx_1, .. du/dx_Dim, r (1 + Dim) numbers for phi of r rows. Outside the
  /// domain u goes on as a Continuation.
  /// @param jets    r (1 + Dim) x as many columns as points.
  /// @param inside  1 where the domain holds the point, else 0.
  virtual void sample(std::span<const Point<Dim>> x, Eigen::Ref<Eigen::MatrixXd> jets,
                      std::span<std::uint8_t> inside) const = 0;
};

}  // namespace crease

#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "Core/Point.h"

namespace crease {

/// A map from R^InDim to R^OutDim with parameters: 2 -> 2 deforms a mammogram, 3 -> 3 a volume, 2 -> 3
/// is a shell's middle surface. In registration it carries points of the fixed image to the moving
/// image, both in mm (LPS).
template <int InDim, int OutDim = InDim>
class Transform {
 public:
  virtual ~Transform() = default;
  virtual std::unique_ptr<Transform> clone() const = 0;

  /// The image T(x) of x, in mm.
  virtual Point<OutDim> map(const Point<InDim>& x) const = 0;
  /// dT/dx at x: OutDim x InDim, row = output coordinate, column = input coordinate; no unit.
  virtual Matrix<OutDim, InDim> spatial_jacobian(const Point<InDim>& x) const = 0;
  /// All that is asked of a sample, for less than one by one.
  struct Sample {
    Point<OutDim> point;             ///< map(x)
    Matrix<OutDim, InDim> jacobian;  ///< spatial_jacobian(x)
    bool in_domain = true;
  };
  /// map, spatial_jacobian and in_domain at x.
  virtual Sample sample(const Point<InDim>& x) const {
    return {map(x), spatial_jacobian(x), in_domain(x)};
  }
  /// Whether T is defined by its spline at x; outside, `map` continues as its class documents.
  virtual bool in_domain(const Point<InDim>&) const { return true; }

  /// What can be varied; each class says what it is and in which order.
  virtual Eigen::Index num_parameters() const = 0;
  virtual Eigen::VectorXd parameters() const = 0;
  /// @throws InvalidInput when the size is not num_parameters() or an entry is not finite.
  virtual void set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) = 0;
  /// Adds sum_k (dT(x_k)/dp)^T F_k to the gradient (num_parameters()): the adjoint of the Jacobian by
  /// the parameters, which carries forces at mapped points back onto the parameters.
  virtual void add_adjoint(std::span<const Point<InDim>> x, std::span<const Vector<OutDim>> forces,
                           Eigen::Ref<Eigen::VectorXd> gradient) const = 0;
};

}  // namespace crease

#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>

#include "Core/Point.h"

namespace crease {

template <int InDim, int OutDim>
class TransformSampler;

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
  /// The same for many points that lie near each other; the transform must outlive it.
  virtual std::unique_ptr<TransformSampler<InDim, OutDim>> sampler() const;
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
  /// (dT/dp)^T at some points, num_parameters() x (OutDim x.size()): column OutDim k + a belongs to
  /// coordinate a of T(x_k). The adjoint of unit forces, unless a class has a faster way.
  virtual Eigen::MatrixXd parameter_jacobian(std::span<const Point<InDim>> x) const {
    Eigen::MatrixXd columns =
        Eigen::MatrixXd::Zero(num_parameters(), OutDim * static_cast<Eigen::Index>(x.size()));
    for (std::size_t k = 0; k < x.size(); ++k) {
      for (int a = 0; a < OutDim; ++a) {
        const Vector<OutDim> unit = Vector<OutDim>::Unit(a);
        add_adjoint(x.subspan(k, 1), std::span(&unit, 1),
                    columns.col(OutDim * static_cast<Eigen::Index>(k) + a));
      }
    }
    return columns;
  }
  /// Whether T(x) is an affine function of the parameters, so that what they are to do at points can be
  /// written as linear equations and parameter_jacobian() does not depend on them.
  virtual bool linear_in_parameters() const { return false; }
  /// R, symmetric and positive semi-definite, where p^T R p says how rough T is in the sense of its class
  /// (parameters zero: not at all); nullopt where it knows no such measure.
  virtual std::optional<Eigen::MatrixXd> roughness_matrix() const { return std::nullopt; }
};

extern template class Transform<2, 2>;
extern template class Transform<3, 3>;
extern template class Transform<2, 3>;

}  // namespace crease

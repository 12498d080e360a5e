#pragma once

#include <array>

#include "Core/Raster.h"
#include "Transforms/Transform.h"

namespace crease {

/// T(x) = x + u(x), u given at the samples of a raster (mm) and linear along each axis between them: what
/// ITK's DisplacementFieldTransform makes of a displacement field.
///
/// As there, a point belongs to the field when its index lies in [-0.5, size - 0.5) along every axis, and
/// its index is clamped to [0, size - 1], the centres of the outer samples. Beyond, T is the identity,
/// with a jump at the border. The direction need not be orthonormal, but must be invertible.
///
/// Parameters: the displacements, sample by sample (first axis fastest), all coordinates of one together;
/// those of ITK. A point costs 2^Dim terms. The spatial Jacobian is that of the interpolant; on planes
/// between cells, where it jumps, that of the cell with the higher index.
template <int Dim>
class DisplacementFieldTransform final : public Transform<Dim> {
 public:
  /// The identity. @throws InvalidInput when the raster has no samples, a spacing is not positive, the
  /// direction is singular or a number is not finite.
  explicit DisplacementFieldTransform(const Raster<Dim>& raster);
  /// @param displacements  Dim x num_samples, mm.
  /// @throws InvalidInput as above, or when their number is another or an entry is not finite.
  DisplacementFieldTransform(const Raster<Dim>& raster, ControlPoints<Dim> displacements);

  const Raster<Dim>& raster() const { return raster_; }
  /// u at the samples: Dim x num_samples, mm.
  const ControlPoints<Dim>& displacements() const { return displacements_; }

  std::unique_ptr<Transform<Dim>> clone() const override;
  Point<Dim> map(const Point<Dim>& x) const override;
  Matrix<Dim> spatial_jacobian(const Point<Dim>& x) const override;
  typename Transform<Dim>::Sample sample(const Point<Dim>& x) const override;
  /// Whether x lies within the border above.
  bool in_domain(const Point<Dim>& x) const override;
  Eigen::Index num_parameters() const override { return displacements_.size(); }
  bool linear_in_parameters() const override { return true; }
  Eigen::VectorXd parameters() const override;
  void set_parameters(const Eigen::Ref<const Eigen::VectorXd>& parameters) override;
  void add_adjoint(std::span<const Point<Dim>> x, std::span<const Vector<Dim>> forces,
                   Eigen::Ref<Eigen::VectorXd> gradient) const override;

 private:
  static constexpr int kNumCorners = 1 << Dim;
  /// The cell that holds a point: u = sum_c weights_c u_c over its corners.
  struct Cell {
    bool inside = false;
    std::array<Eigen::Index, kNumCorners> corners{};
    Eigen::Matrix<double, kNumCorners, 1> weights;
  };
  bool is_inside(const Vector<Dim>& index) const;
  /// @param slopes  d weights / d index (corners x axes); null: not wanted.
  Cell locate(const Point<Dim>& x, Eigen::Matrix<double, kNumCorners, Dim>* slopes = nullptr) const;

  Raster<Dim> raster_;
  Matrix<Dim> point_to_index_;
  ControlPoints<Dim> displacements_;
};

extern template class DisplacementFieldTransform<2>;
extern template class DisplacementFieldTransform<3>;

}  // namespace crease

#pragma once

#include <array>
#include <memory>
#include <utility>

#include "Registration/Phantoms/Random.h"
#include "Transforms/AffineMap.h"
#include "Transforms/Transform.h"

namespace crease {

/// One sine of a smooth displacement along one axis: amplitude sin(k . x + phase).
struct DisplacementWave {
  double amplitude_mm = 0;
  Vector<2> wave_vector = Vector<2>::Zero();  ///< k, radians per mm; 2 pi / |k| is the wavelength
  double phase_rad = 0;
};

/// A smooth motion of the breast: an affine map and two waves along each axis.
struct MammogramMotion {
  double rotation_rad = 0;                ///< about the centre, from x to y; at most 4 degrees
  Vector<2> stretch = Vector<2>::Zero();  ///< scale - 1 along x and y, at most 6 %
  double shear = 0;                       ///< of x by y, at most 6 %
  Point<2> center = Point<2>::Zero();     ///< mm
  std::array<std::array<DisplacementWave, 2>, 2> waves;  ///< [axis]

  AffineMap<2> affine() const;
  /// The same with all of it by a factor.
  MammogramMotion scaled(double factor) const;
};

/// Draws the affine part evenly within its limits, and waves with amplitudes up to 0.025 and half
/// wavelengths of 0.3 to 0.6 of the frame's width.
MammogramMotion draw_mammogram_motion(Random random);

/// The true map of a mammogram phantom, fixed to moving, mm: the sum of displacements
///
///     T(x) = x + (A(x) - x) + sum of waves(x) + (F(x) - x),
///
/// A affine, F a further map, for instance of an elastic body. Without one, and where F is not defined
/// (Transform::in_domain), the last part is missing: F(x) = x at the border of its domain, or T tears there.
class MammogramDeformation {
 public:
  explicit MammogramDeformation(MammogramMotion motion,
                                std::shared_ptr<const Transform<2>> further = nullptr);

  const MammogramMotion& motion() const { return motion_; }
  Point<2> operator()(const Point<2>& x) const { return sample(x).first; }
  Matrix<2> jacobian(const Point<2>& x) const { return sample(x).second; }
  /// x with |T(x) - y| < 4e-12 mm, less than 1e-10 pixels of 0.04 mm and more, by Newton's method; where a
  /// step does not lead closer, as it may across a crease of F, by a step of the fixed point
  /// x <- x + y - T(x).
  /// @param start  a point near x; y itself will do.
  /// @throws SolverError when that is not reached: F folds.
  Point<2> inverse(const Point<2>& y, const Point<2>& start) const;
  /// Smallest and largest determinant of T's derivative on a grid of 257 x 257 points of the frame.
  std::pair<double, double> determinant_range() const;

 private:
  std::pair<Point<2>, Matrix<2>> sample(const Point<2>& x) const;

  MammogramMotion motion_;
  AffineMap<2> affine_;
  std::shared_ptr<const Transform<2>> further_;
};

}  // namespace crease

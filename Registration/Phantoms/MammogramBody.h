#pragma once

#include <memory>

#include "Registration/Phantoms/MammogramDeformation.h"
#include "Transforms/Domains/DomainMesh.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {

/// The region label of the pectoral muscle in a mesh of the breast.
inline constexpr int kPectoralRegion = 1;

/// The breast of the mammogram phantom in triangles, mm, with the edge of the pectoral muscle along their edges. The
/// border runs off the skin line by 0.3 mm at most with 600 triangles, by less with more.
/// @param muscle  else the breast is all of one tissue.
DomainMesh mesh_of_mammogram(int num_triangles, bool muscle = true);

/// What a breast is made of.
struct MammogramBodyOptions {
  int num_triangles = 16 * 600;  ///< sixteen times as fine as the meshes that registrations use
  bool muscle = true;            ///< the pectoral muscle
  double muscle_stiffness = 10;  ///< its Young's modulus over that of the breast
};

/// The breast of the mammogram phantom as an elastic body in plane stress: neo-Hookean tissue, nu = 0.495, the
/// pectoral muscle stiffer than the rest.
///
/// Its whole border, skin and chest wall, follows a given motion M, and elasticity decides where the inside
/// goes: the strain jumps at the muscle. The equilibrium is found in Lagrange's quadratic elements.
class MammogramBody {
 public:
  explicit MammogramBody(const MammogramBodyOptions& options = {});

  /// Where the tissue goes beyond the motion of its border.
  struct Equilibrium {
    /// x + w(x), w zero on the border: the tissue goes to M(x) + w(x). For MammogramDeformation.
    std::shared_ptr<const SplineTransform<2>> further;
    double least_determinant = 0;  ///< of the tissue's map over the points of quadrature
  };
  /// @throws NoEquilibrium when the motion folds tissue.
  Equilibrium follow(const MammogramMotion& motion) const;

 private:
  std::shared_ptr<const TriangularBSplineBasis<2>> basis_;
  double muscle_stiffness_;
};

}  // namespace crease

#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "Transforms/AffineMap.h"
#include "Transforms/Energies/ElasticPatch.h"
#include "Transforms/Energies/ElasticQuadrature.h"
#include "Transforms/Energies/Energy.h"

namespace crease {

/// How an elastic energy is integrated.
template <int Dim>
struct ElasticOptions {
  /// What evaluate() gives.
  ElasticTangent tangent = ElasticTangent::kSemidefinite;
  ElasticQuadrature quadrature = ElasticQuadrature::kCells;
  /// Degree of the quadrature in cells; negative: 4 (n - 1) for St. Venant-Kirchhoff, which is exact, and two more for
  /// neo-Hookean tissue, whose energy is no polynomial.
  int quadrature_degree = -1;
  /// The region of a point, for bases whose patches have none; null: that of the patch.
  std::function<int(const Point<Dim>& x)> region_at = {};
};

/// The energy that a nonlinearly elastic body stores when T = A + u deforms it, F = grad T:
///
///     W = int W(F) dx,   R_i = dW/dphi_i = int P grad B_i dx,
///     K_ik = int grad B_i . dP/dF . grad B_k dx,   W(F), P: StoredEnergy.h
///
/// W and R vanish for rigid motions. With a mean dilatation, over each patch of area V,
///
///     lambda/2 int tr(E)^2 dx   becomes   V lambda/2 m^2,        m = 1/V int tr(E) dx,
///     lambda/2 int (ln J)^2 dx  becomes   V lambda/2 (ln m)^2,   m = 1/V int J dx,
///
/// in W, R and K alike; the part with mu stays as it is. Where a neo-Hookean map folds, W is infinite.
/// Cells are integrated one by one (unless the quadrature is cheap); the bands of creases count like all others.
///
/// Source: dissertation, (4.1) to (4.6); mean dilatation: J. C. Nagtegaal, D. M. Parks, J. R. Rice, "On
/// Numerically Accurate Finite Element Solutions in the Fully Plastic Range", Comput. Methods Appl. Mech.
/// Eng. 4, 1974; semi-definite part: J. Teran, E. Sifakis, G. Irving, R. Fedkiw, "Robust Quasistatic Finite
/// Elements and Flesh Simulation", SCA 2005.
template <int Dim>
class ElasticEnergy final : public Energy<Dim> {
 public:
  /// @param affine  the affine part of T, whose strain counts.
  /// @throws InvalidInput as check_material(), and when the material names a region that no patch has.
  explicit ElasticEnergy(const SplineBasis<Dim>& basis, const ElasticMaterial& material = {},
                         const AffineMap<Dim>& affine = {},
                         const ElasticOptions<Dim>& options = {});

  double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                  ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian) const override;
  /// The same with the tangent of one's choice; tells the least determinant where `least` is not null. Where W
  /// is infinite nothing is added.
  double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                  ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian, ElasticTangent tangent,
                  LeastDeterminant<Dim>* least) const;
  bool couples_coordinates() const override { return true; }
  /// 1/2 int kappa |F - R|^2 dx with kappa = mu + (lambda + mu) / Dim, what the tangent at rest is on average
  /// over the coordinates, and R the rotation nearest to the mean of F over a patch, renewed with phi0.
  void add_stiffness(double scale, const HessianPattern& pattern,
                     std::span<double> stiffness) const override;
  bool add_pull(const Eigen::Ref<const ControlPoints<Dim>>& phi0, double scale,
                ControlPoints<Dim>& pull) const override;

  const ElasticMaterial& material() const { return material_; }
  /// Largest lambda + 2 mu, in the unit of Young's modulus.
  double largest_stiffness() const { return largest_stiffness_; }
  /// Area (mm^2) or volume (mm^3) that is integrated.
  double measure() const { return measure_; }
  /// For Hessians: the pattern of the basis; with a mean dilatation all pairs of a patch as well.
  const std::shared_ptr<const HessianPattern>& pattern() const { return pattern_; }

 private:
  void set_materials(std::vector<GradientPatch<Dim>> patches, const ElasticOptions<Dim>& options);
  void set_slots(const SplineBasis<Dim>& basis);
  std::shared_ptr<const HessianPattern> whole_patch_pattern(const SplineBasis<Dim>& basis) const;
  void add_patch_hessian(std::size_t p, const ElasticSums<Dim>& sums, double scale,
                         BlockHessian<Dim>& hessian) const;

  ElasticMaterial material_;
  Matrix<Dim> linear_;
  ElasticTangent tangent_;
  int num_control_points_;
  std::shared_ptr<const HessianPattern> pattern_;
  std::vector<ElasticPatch<Dim>> patches_;
  std::vector<std::vector<int>>
      slots_;  // per patch: of its pairs i >= k in pattern_; -1: no coupling
  double largest_stiffness_ = 0, measure_ = 0;
};

/// |K_a - K_b| / |K_b| in the norm of Frobenius, tangents at rest of two energies on one basis: what a
/// quadrature is worth.
template <int Dim>
double relative_tangent_difference(const ElasticEnergy<Dim>& a, const ElasticEnergy<Dim>& b);

extern template double relative_tangent_difference<2>(const ElasticEnergy<2>&,
                                                      const ElasticEnergy<2>&);
extern template double relative_tangent_difference<3>(const ElasticEnergy<3>&,
                                                      const ElasticEnergy<3>&);
extern template class ElasticEnergy<2>;
extern template class ElasticEnergy<3>;

}  // namespace crease

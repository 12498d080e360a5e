#pragma once

#include "Transforms/AffineMap.h"
#include "Transforms/Energies/Energy.h"
#include "Transforms/Energies/GradientCells.h"
#include "Transforms/Energies/WeightField.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// How E_R is differentiated and integrated.
template <int Dim>
struct RigidityOptions {
  /// The true Hessian, which may be indefinite, instead of Gauss-Newton's.
  bool exact_hessian = false;
  /// Degree of the quadrature; negative: exact for weights that are constant in every cell.
  int quadrature_degree = -1;
  /// Patches that may carry weight; null: all. Saves the quadrature of the others.
  std::function<bool(int region, int patch)> wanted;
};

/// E_R = 1/2 int w |E|_F^2 dx with the Green-St. Venant strain E = 1/2 (F^T F - I), F = grad T = A + grad u:
/// zero exactly where T moves rigidly (or mirrors) the tissue of weight w.
///
///     dE_R/dphi_i = int w F E grad B_i dx
///     Gauss-Newton block (i, k) = int w 1/2 [ F F^T (grad B_i . grad B_k) + (F grad B_k)(F grad B_i)^T ] dx
///     exact: plus I int w (grad B_i . E grad B_k) dx
///
/// For a body that moves nearly rigidly F is one rotation R, and the block becomes
/// 1/2 [ tr(M_ik) I + R M_ik^T R^T ] with M_ik = int w grad B_i grad B_k^T dx, integrated once.
///
/// Cells without weight, and the bands of creases without a body side, are left out. Cost per cell: the
/// gradient of T at its points; where a body is strained, also one symmetric product of the Dim k strain
/// rows by the points.
///
/// Source: dissertation, (3.6) and (4.2), whose 1/2 in E is kept.
template <int Dim>
class RigidityEnergy final : public Energy<Dim> {
 public:
  /// @param weights  null: 1 everywhere.
  /// @param affine   the affine part of T.
  /// @throws InvalidInput when a weight lies outside [0, 1].
  explicit RigidityEnergy(const SplineBasis<Dim>& basis,
                          const WeightField<Dim>& weights = body_weights<Dim>(),
                          const AffineMap<Dim>& affine = {},
                          const RigidityOptions<Dim>& options = {});

  /// Integral of w over the cells that count, mm^Dim: what E_R is compared with.
  double weighted_measure() const { return weighted_measure_; }
  double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                  ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian) const override;
  bool couples_coordinates() const override { return true; }
  /// 1/2 int w |F - R|^2 dx with R the rotation nearest to the mean of F over a body (over a cell where
  /// the basis knows no bodies): small strains about a rigid motion, which is renewed with phi0.
  void add_stiffness(double scale, const HessianPattern& pattern,
                     std::span<double> stiffness) const override;
  bool add_pull(const Eigen::Ref<const ControlPoints<Dim>>& phi0, double scale,
                ControlPoints<Dim>& pull) const override;

 private:
  using Cell = GradientCell<Dim>;
  using Patch = GradientPatch<Dim>;
  using Sums = PatchSums<Dim>;
  /// Patches of one region; a patch of a basis without regions stands on its own.
  struct Body {
    /// Of two control points.
    struct Coupling {
      int i, k;         // i >= k
      Matrix<Dim> sum;  // M_ik
    };
    std::vector<int> patches;
    double measure = 0;               // int w dx
    std::vector<int> control_points;  // ascending
    ControlPoints<Dim> moments;       // int w grad B_i dx
    std::vector<Coupling> couplings;  // by i, then k
  };
  void add_cell(const Cell& cell, const ControlPoints<Dim>& phi, bool with_gradient,
                bool with_hessian, Sums& sums) const;
  void add_hessian(const Cell& cell, const ControlPoints<Dim>& table, Sums& sums) const;
  Sums evaluate_patch(const Patch& patch, const Eigen::Ref<const ControlPoints<Dim>>& phi,
                      bool with_gradient, bool with_hessian) const;
  void make_bodies();
  Matrix<Dim> rotation_of(const Body& body, const Eigen::Ref<const ControlPoints<Dim>>& phi) const;
  void add_rigid_hessian(const Body& body, const Matrix<Dim>& rotation, double scale,
                         BlockHessian<Dim>& hessian) const;
  void add_strained_hessian(const Body& body, const Eigen::Ref<const ControlPoints<Dim>>& phi,
                            double scale, BlockHessian<Dim>& hessian) const;

  Matrix<Dim> linear_;
  bool exact_hessian_;
  double weighted_measure_ = 0;
  int num_control_points_;
  std::vector<Patch> patches_;
  std::vector<Body> bodies_;
};

extern template class RigidityEnergy<2>;
extern template class RigidityEnergy<3>;

}  // namespace crease

#pragma once

#include <array>

#include "Transforms/AffineMap.h"
#include "Transforms/Energies/Energy.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// Where and how folding is punished.
struct FoldingOptions {
  double threshold = 0.1;  ///< delta: det F above it costs nothing
  /// Degree of the quadrature; negative: enough to see narrow folds, for cubics 4 points per axis of a knot span
  /// and 3 per cell of knot lines.
  int quadrature_degree = -1;
  /// Patches that are watched; null: all.
  std::function<bool(int region, int patch)> wanted;
};

/// E_F = int p(det F) dx with p(d) = max(0, 1 - d / delta)^4 and F = grad T = A + grad u: what keeps a map from
/// folding. It is finite where the map is folded, so that it leads out of folds, too.
///
///     dE_F/dphi_i = int p' cof F grad B_i dx
///     Gauss-Newton block (i, k) = int p'' (cof F grad B_i) (cof F grad B_k)^T dx,   p'' >= 0
///
/// Cost: like a value of rigidity, but only points with det F < delta cost more than F itself.
template <int Dim>
class FoldingEnergy final : public Energy<Dim> {
 public:
  /// @param affine  the affine part of T.
  /// @throws InvalidInput when the threshold is not positive or the affine part is not finite.
  explicit FoldingEnergy(const SplineBasis<Dim>& basis, const AffineMap<Dim>& affine = {},
                         const FoldingOptions& options = {});

  /// Area or volume of the patches that are watched, mm^Dim.
  double measure() const { return measure_; }
  /// The least det F at its points.
  double least_determinant(const Eigen::Ref<const ControlPoints<Dim>>& phi) const;
  /// The same energy with another threshold. @throws InvalidInput as above.
  FoldingEnergy with_threshold(double threshold) const;
  double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                  ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian) const override;
  bool couples_coordinates() const override { return true; }

 private:
  struct Element {
    std::vector<int> control_points;
    Eigen::VectorXd weights;
    std::shared_ptr<const std::vector<Eigen::MatrixXd>>
        gradients;  // the spans of a lattice share them
  };
  struct Part;
  std::array<ControlPoints<Dim>, Dim> columns(const Element& element,
                                              const ControlPoints<Dim>& local) const;
  Part evaluate_element(const Element& element, const Eigen::Ref<const ControlPoints<Dim>>& phi,
                        bool with_gradient, bool with_hessian) const;

  double threshold_;
  Matrix<Dim> linear_;
  int num_control_points_;
  double measure_ = 0;
  std::vector<Element> elements_;
};

extern template class FoldingEnergy<2>;
extern template class FoldingEnergy<3>;

}  // namespace crease

#pragma once

#include <vector>

#include "Transforms/Splines/BorderPieces.h"
#include "Transforms/Splines/SplineSampler.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {

class TriangularBSplineEvaluator;

/// A triangular B-spline at many points: in cores by the triangle's polynomial, in strips 16 neighbours at a
/// time, outside by the pieces along the border's edges.
class TriangularBSplineSampler final : public SplineSampler<2> {
 public:
  /// All but the control points must outlive the sampler.
  /// @param control_points  phi: 2 or 3 rows.
  TriangularBSplineSampler(const TriangularBSplineBasis<2>& basis,
                           const TriangularBSplineEvaluator& evaluator,
                           const NearestFacets<2>& border,
                           const Eigen::Ref<const Eigen::MatrixXd>& control_points);

  void sample(std::span<const Point<2>> x, Eigen::Ref<Eigen::MatrixXd> jets,
              std::span<std::uint8_t> inside) const override;

 private:
  class StripPoints;
  using Jet = Eigen::Ref<Eigen::VectorXd>;
  void sample_core(int triangle, const Point<2>& x, Jet jet) const;
  void sample_outside(const Point<2>& x, Jet jet) const;
  BorderPieces pieces_along(int edge) const;

  const TriangularBSplineBasis<2>& basis_;
  const TriangularBSplineEvaluator& evaluator_;
  const NearestFacets<2>& border_;
  Eigen::MatrixXd phi_;
  std::vector<Eigen::MatrixXd> cores_;  // per triangle: coefficients of its power form
  std::vector<BorderPieces> pieces_;    // of the border's edges
};

}  // namespace crease

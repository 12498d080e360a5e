#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "Core/Point.h"

namespace crease {

/// A spline and its gradient along one straight edge, where both are polynomials between knot lines.
class BorderPieces {
 public:
  /// Evaluates at points of the edge: one column each (values and derivatives).
  using Evaluation = std::function<Eigen::MatrixXd(const std::vector<double>& parameters)>;

  /// @param breaks    parameters in (0, 1) where knot lines cross the edge, in any order, repeated or not.
  /// @param degree    of the polynomials.
  /// @param evaluate  never asked at a break.
  BorderPieces(std::vector<double> breaks, int degree, const Evaluation& evaluate);

  /// At a parameter in [0, 1]; at a break from one of its sides.
  void evaluate(double parameter, Eigen::Ref<Eigen::VectorXd> jet) const;

 private:
  std::vector<double> starts_;           // of the pieces, ascending, the first 0
  std::vector<Eigen::MatrixXd> pieces_;  // coefficients of powers of the place in the piece, 0 to 1
};

}  // namespace crease

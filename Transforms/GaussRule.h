#pragma once

#include <vector>

namespace crease {

/// Gauss-Legendre rule on [0, 1]: sum_i weights[i] f(points[i]) is the integral for all polynomials f
/// of degree <= 2 * n - 1. Points ascend.
struct GaussRule {
  std::vector<double> points;
  std::vector<double> weights;  ///< sum = 1
};

/// @param num_points  n >= 1. @throws InvalidInput otherwise.
GaussRule gauss_rule(int num_points);

}  // namespace crease

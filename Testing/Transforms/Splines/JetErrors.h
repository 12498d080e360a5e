#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "Transforms/Splines/SimplexSpline.h"

namespace crease::testing {

/// Largest errors of values, gradients and second derivatives over a set of points, and the largest
/// entries, to which the errors are compared.
struct JetErrors {
  std::array<double, 3> error{}, scale{};

  void add(int order, double difference, double truth) {
    error[order] = std::max(error[order], difference);
    scale[order] = std::max(scale[order], truth);
  }
  template <int Dim>
  void add(const SplineJet<Dim>& found, double value, const std::vector<double>& gradient,
           const std::vector<double>& hessian) {
    add(0, std::abs(found.value - value), std::abs(value));
    for (std::size_t a = 0; a < gradient.size(); ++a) {
      add(1, std::abs(found.gradient[a] - gradient[a]), std::abs(gradient[a]));
    }
    for (std::size_t s = 0; s < hessian.size(); ++s) {
      add(2, std::abs(found.hessian[s] - hessian[s]), std::abs(hessian[s]));
    }
  }
  /// The tolerances of the theory: 1e-13, 1e-12 and 1e-11 of the largest entry.
  void expect_small(const std::string& what) const {
    const std::array<double, 3> tolerance = {1e-13, 1e-12, 1e-11};
    for (int order = 0; order < 3; ++order) {
      EXPECT_LE(error[order], tolerance[order] * scale[order]) << what << ", derivative " << order;
    }
  }
};

}  // namespace crease::testing

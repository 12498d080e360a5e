#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <vector>

#include "Testing/Transforms/Splines/JetErrors.h"
#include "Transforms/Splines/BPatchIndices.h"
#include "Transforms/Splines/KnotLocator.h"

namespace crease::testing {

using Rational = boost::multiprecision::cpp_rational;

template <int Dim>
using ExactPoint = std::array<Rational, Dim>;

/// Doubles are binary fractions: nothing is rounded.
template <int Dim>
ExactPoint<Dim> exact(const Point<Dim>& p) {
  ExactPoint<Dim> result;
  for (int a = 0; a < Dim; ++a) result[a] = Rational(p[a]);
  return result;
}

/// det[w_1 - w_0, ..]
template <int Dim>
Rational exact_content(const std::array<ExactPoint<Dim>, Dim + 1>& w) {
  const auto d = [&](int j, int a) -> Rational { return w[j][a] - w[0][a]; };
  if constexpr (Dim == 2) {
    return d(1, 0) * d(2, 1) - d(1, 1) * d(2, 0);
  } else {
    return d(1, 0) * (d(2, 1) * d(3, 2) - d(2, 2) * d(3, 1)) -
           d(1, 1) * (d(2, 0) * d(3, 2) - d(2, 2) * d(3, 0)) +
           d(1, 2) * (d(2, 0) * d(3, 1) - d(2, 1) * d(3, 0));
  }
}

/// Value and derivatives in the order of SplineJet.
template <int Dim>
struct ExactJet {
  Rational value = 0;
  std::array<Rational, Dim> gradient{};
  std::array<Rational, kNumSecondDerivatives<Dim>> hessian{};

  void add(const Rational& factor, const ExactJet& other) {
    value += factor * other.value;
    for (int a = 0; a < Dim; ++a) gradient[a] += factor * other.gradient[a];
    for (int s = 0; s < kNumSecondDerivatives<Dim>; ++s) hessian[s] += factor * other.hessian[s];
  }
};

/// Simplex splines in exact arithmetic, with other choices than the library's: the recurrence splits at
/// the first knots that span a simplex, not at the largest, and derivatives are those of its products.
template <int Dim>
class ExactSimplexSpline {
 public:
  /// @param flag  directions of the one-sided limit.
  ExactSimplexSpline(const Point<Dim>& u, std::span<const Vector<Dim>> flag) : u_(exact<Dim>(u)) {
    for (const auto& direction : flag) flag_.push_back(exact<Dim>(direction));
  }

  ExactJet<Dim> evaluate(const std::vector<ExactPoint<Dim>>& knots) const {
    ExactJet<Dim> jet;
    std::array<std::size_t, Dim + 1> split;
    if (far_from(knots) || !find_split(knots, split)) return jet;
    std::array<ExactPoint<Dim>, Dim + 1> w;
    for (int j = 0; j <= Dim; ++j) w[j] = knots[split[j]];
    const Rational whole = exact_content<Dim>(w);
    bool inside = true;
    for (int j = 0; j <= Dim; ++j) {
      auto replaced = w;
      replaced[j] = u_;
      const Rational lambda = exact_content<Dim>(replaced) / whole;
      std::array<Rational, Dim> slope;  // lambda is affine: a unit step shows its slope
      for (int a = 0; a < Dim; ++a) {
        replaced[j][a] += 1;
        slope[a] = exact_content<Dim>(replaced) / whole - lambda;
        replaced[j][a] -= 1;
      }
      if (knots.size() == Dim + 1) {
        inside = inside && side(lambda, slope) > 0;
        continue;
      }
      auto rest = knots;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(split[j]));
      add_product(lambda, slope, evaluate(rest), jet);
    }
    if (knots.size() == Dim + 1 && inside) jet.value = 1 / abs(whole);
    return jet;
  }

 private:
  bool far_from(const std::vector<ExactPoint<Dim>>& knots) const {
    for (int a = 0; a < Dim; ++a) {
      bool below = true, above = true;
      for (const auto& knot : knots) {
        below = below && knot[a] < u_[a];
        above = above && knot[a] > u_[a];
      }
      if (below || above) return true;
    }
    return false;
  }

  static bool find_split(const std::vector<ExactPoint<Dim>>& knots,
                         std::array<std::size_t, Dim + 1>& split) {
    std::vector<bool> chosen(knots.size(), false);
    std::fill(chosen.begin(), chosen.begin() + Dim + 1, true);
    do {  // all subsets in lexicographic order
      std::array<ExactPoint<Dim>, Dim + 1> w;
      for (std::size_t i = 0, j = 0; i < knots.size(); ++i) {
        if (!chosen[i]) continue;
        split[j] = i;
        w[j++] = knots[i];
      }
      if (exact_content<Dim>(w) != 0) return true;
    } while (std::prev_permutation(chosen.begin(), chosen.end()));
    return false;
  }

  int side(const Rational& lambda, const std::array<Rational, Dim>& slope) const {
    if (lambda != 0) return lambda.sign();
    for (const auto& direction : flag_) {
      Rational step = 0;
      for (int a = 0; a < Dim; ++a) step += slope[a] * direction[a];
      if (step != 0) return step.sign();
    }
    return 0;
  }

  static void add_product(const Rational& lambda, const std::array<Rational, Dim>& slope,
                          const ExactJet<Dim>& rest, ExactJet<Dim>& jet) {
    jet.add(lambda, rest);
    for (int a = 0; a < Dim; ++a) {
      jet.gradient[a] += slope[a] * rest.value;
      for (int b = a; b < Dim; ++b) {
        jet.hessian[second_derivative_index<Dim>(a, b)] +=
            slope[a] * rest.gradient[b] + slope[b] * rest.gradient[a];
      }
    }
  }

  ExactPoint<Dim> u_;
  std::vector<ExactPoint<Dim>> flag_;
};

/// N_beta^I, t_degree = t_0.
template <int Dim>
ExactJet<Dim> exact_local_function(const KnotNet<Dim>& net, int simplex,
                                   const MultiIndex<Dim>& beta,
                                   const ExactSimplexSpline<Dim>& spline) {
  std::vector<ExactPoint<Dim>> knots;
  std::array<ExactPoint<Dim>, Dim + 1> corners;
  for (int j = 0; j <= Dim; ++j) {
    const auto& cloud = net.clouds[net.mesh.simplices[simplex][j]];
    for (int k = 0; k <= beta[j]; ++k) knots.push_back(exact<Dim>(cloud[k % net.degree]));
    corners[j] = knots.back();
  }
  ExactJet<Dim> jet;
  jet.add(abs(exact_content<Dim>(corners)), spline.evaluate(knots));
  return jet;
}

/// |found - truth| and |truth| of value, gradient and second derivatives, added to the errors.
template <int Dim>
void add_errors(const SplineJet<Dim>& found, const ExactJet<Dim>& truth, JetErrors& errors) {
  const auto add = [&](int order, double value, const Rational& exact_value) {
    errors.add(order, static_cast<double>(abs(Rational(value) - exact_value)),
               static_cast<double>(abs(exact_value)));
  };
  add(0, found.value, truth.value);
  for (int a = 0; a < Dim; ++a) add(1, found.gradient[a], truth.gradient[a]);
  for (int s = 0; s < kNumSecondDerivatives<Dim>; ++s) add(2, found.hessian[s], truth.hessian[s]);
}

}  // namespace crease::testing

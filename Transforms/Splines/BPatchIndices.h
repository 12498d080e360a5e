#pragma once

#include <array>
#include <vector>

namespace crease {

/// Largest degree of a triangular B-spline.
inline constexpr int kMaxSplineDegree = 5;

/// beta = (b_0, .., b_Dim), b_i >= 0: numbers a local function of a simplex by how many knots it takes
/// from each cloud.
template <int Dim>
using MultiIndex = std::array<int, Dim + 1>;

/// How many multi-indices have the sum `degree`: C(degree + Dim, Dim).
template <int Dim>
constexpr int num_multi_indices(int degree) {
  int count = 1;
  for (int a = 1; a <= Dim; ++a) count = count * (degree + a) / a;
  return count;
}

/// Place of beta among those of its sum, in the order (n,0,0), (n-1,1,0), (n-1,0,1), (n-2,2,0), ...
/// It depends on b_1, b_2 (, b_3) only; for exponents (., i, j) it numbers the monomials X^i Y^j by
/// rising degree.
template <int Dim>
constexpr int multi_index_position(const MultiIndex<Dim>& beta) {
  if constexpr (Dim == 2) {
    const int rest = beta[1] + beta[2];
    return rest * (rest + 1) / 2 + beta[2];
  } else {
    const int rest = beta[1] + beta[2] + beta[3], inner = beta[2] + beta[3];
    return rest * (rest + 1) * (rest + 2) / 6 + inner * (inner + 1) / 2 + beta[3];
  }
}

/// All multi-indices of one sum in that order.
template <int Dim>
std::vector<MultiIndex<Dim>> multi_indices(int degree) {
  std::vector<MultiIndex<Dim>> all;
  for (int b0 = degree; b0 >= 0; --b0) {
    for (int b1 = degree - b0; b1 >= 0; --b1) {
      if constexpr (Dim == 2) {
        all.push_back({b0, b1, degree - b0 - b1});
      } else {
        for (int b2 = degree - b0 - b1; b2 >= 0; --b2) {
          all.push_back({b0, b1, b2, degree - b0 - b1 - b2});
        }
      }
    }
  }
  return all;
}

/// Exponents (i, j[, k]) of the monomials up to kMaxSplineDegree by rising degree: entry p is the one
/// whose multi_index_position is p.
template <int Dim>
inline constexpr auto kMonomials = [] {
  std::array<std::array<int, Dim>, num_multi_indices<Dim>(kMaxSplineDegree)> all{};
  for (int i = 0; i <= kMaxSplineDegree; ++i) {
    for (int j = 0; i + j <= kMaxSplineDegree; ++j) {
      if constexpr (Dim == 2) {
        all[multi_index_position<2>({0, i, j})] = {i, j};
      } else {
        for (int k = 0; i + j + k <= kMaxSplineDegree; ++k) {
          all[multi_index_position<3>({0, i, j, k})] = {i, j, k};
        }
      }
    }
  }
  return all;
}();

}  // namespace crease

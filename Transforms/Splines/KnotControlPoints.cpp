#include "Transforms/Splines/KnotControlPoints.h"

#include <algorithm>
#include <unordered_map>

namespace crease {
namespace {

// (vertex, knots taken from it) for the vertices that give any, ascending.
template <int Dim>
using Key = std::array<std::pair<int, int>, Dim + 1>;

template <int Dim>
struct KeyHash {
  std::size_t operator()(const Key<Dim>& key) const {
    std::size_t h = 0;
    for (const auto& [vertex, taken] : key) {
      h = (h ^ static_cast<std::size_t>(vertex * 8 + taken)) * 0x9e3779b97f4a7c15u;
      h ^= h >> 29;
    }
    return h;
  }
};

template <int Dim>
Key<Dim> make_key(const std::array<int, Dim + 1>& simplex, const MultiIndex<Dim>& beta) {
  Key<Dim> key;
  for (int j = 0; j <= Dim; ++j) {
    key[j] = beta[j] > 0 ? std::pair(simplex[j], beta[j]) : std::pair(-1, 0);
  }
  std::sort(key.begin(), key.end());
  return key;
}

}  // namespace

template <int Dim>
KnotControlPoints<Dim>::KnotControlPoints(const SimplexMesh<Dim>& mesh, int degree)
    : per_simplex_(num_multi_indices<Dim>(degree)) {
  const auto betas = multi_indices<Dim>(degree);
  owners_.assign(mesh.vertices.size(), {-1, {}});
  std::unordered_map<Key<Dim>, int, KeyHash<Dim>> numbers;
  table_.reserve(mesh.simplices.size() * betas.size());
  for (std::size_t s = 0; s < mesh.simplices.size(); ++s) {
    const auto& simplex = mesh.simplices[s];
    for (const auto& beta : betas) {
      int number = -1;
      for (int j = 0; j <= Dim; ++j) {
        if (beta[j] == degree) number = simplex[j];
      }
      if (number < 0) {
        const auto [entry, is_new] = numbers.try_emplace(make_key<Dim>(simplex, beta), count());
        number = entry->second;
        if (is_new) owners_.push_back({-1, {}});
      }
      table_.push_back(number);
      if (owners_[number].simplex < 0) owners_[number] = {static_cast<int>(s), beta};
    }
  }
}

template <int Dim>
double monomial_polar_form(const std::array<int, Dim>& exponents,
                           std::span<const Point<Dim>> arguments) {
  // sums[i][j][k]: over all choices of i, j, k of the arguments seen so far.
  constexpr int kSize = kMaxSplineDegree + 1;
  double sums[kSize][kSize][kSize] = {};
  sums[0][0][0] = 1.0;
  std::array<int, 3> top{};
  for (int a = 0; a < Dim; ++a) top[a] = exponents[a];
  for (const Point<Dim>& x : arguments) {
    for (int i = top[0]; i >= 0; --i) {
      for (int j = top[1]; j >= 0; --j) {
        for (int k = top[2]; k >= 0; --k) {
          if (i > 0) sums[i][j][k] += x[0] * sums[i - 1][j][k];
          if (j > 0) sums[i][j][k] += x[1] * sums[i][j - 1][k];
          if (k > 0) sums[i][j][k] += x[Dim - 1] * sums[i][j][k - 1];
        }
      }
    }
  }
  // Number of choices: the multinomial n! / (i! j! k! (n - i - j - k)!).
  double choices = 1.0;
  int left = static_cast<int>(arguments.size());
  for (int e : top) {
    for (int t = 1; t <= e; ++t) choices = choices * left-- / t;
  }
  return sums[top[0]][top[1]][top[2]] / choices;
}

template class KnotControlPoints<2>;
template class KnotControlPoints<3>;
template double monomial_polar_form<2>(const std::array<int, 2>&, std::span<const Point<2>>);
template double monomial_polar_form<3>(const std::array<int, 3>&, std::span<const Point<3>>);

}  // namespace crease

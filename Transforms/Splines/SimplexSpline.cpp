#include "Transforms/Splines/SimplexSpline.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/Domains/SimplexMesh.h"

namespace crease {
namespace {

constexpr int kMaxDegree = 5;
constexpr double kTie = 1e-11;       // relative distance from a knot line that counts as on it
constexpr double kNoVolume = 1e-10;  // relative determinant that counts as 0

template <int Dim>
double diameter(std::span<const Point<Dim>> points) {
  double largest = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      largest = std::max(largest, (points[i] - points[k]).squaredNorm());
    }
  }
  return std::sqrt(largest);
}

// Whether u, moved an infinitesimal step along the flag, lies on the inner side of the facet opposite
// to corner j, where lambda_j = gradient . (u - foot).
template <int Dim>
bool inner_side(const Vector<Dim>& gradient, double lambda, double tie,
                std::span<const Vector<Dim>> directions) {
  const double norm = gradient.norm();
  if (std::abs(lambda) > tie * norm) return lambda > 0.0;
  for (const Vector<Dim>& d : directions) {
    const double slope = gradient.dot(d);
    if (std::abs(slope) > 1e-13 * norm * d.norm()) return slope > 0.0;
  }
  return false;
}

template <int Dim>
struct Reference {
  Point<Dim> u;
  std::span<const Vector<Dim>> directions;
  double tie;

  SplineJet<Dim> evaluate(const std::vector<Point<Dim>>& knots) const {
    SplineJet<Dim> jet;
    const SplitSet<Dim> split = largest_split_set<Dim>(knots);
    if (split.determinant == 0.0) return jet;
    std::array<Point<Dim>, Dim + 1> corners;
    for (int j = 0; j <= Dim; ++j) corners[j] = knots[split.position[j]];
    const auto gradients = barycentric_gradients<Dim>(corners);
    const int degree = static_cast<int>(knots.size()) - Dim - 1;
    if (degree == 0) {
      for (int j = 0; j <= Dim; ++j) {
        const double lambda = gradients.col(j).dot(u - corners[j == 0 ? 1 : 0]);
        if (!inner_side<Dim>(gradients.col(j), lambda, tie, directions)) return jet;
      }
      jet.value = 1.0 / std::abs(split.determinant);
      return jet;
    }
    for (int j = 0; j <= Dim; ++j) {
      std::vector<Point<Dim>> rest = knots;
      rest.erase(rest.begin() + split.position[j]);
      const SplineJet<Dim> child = evaluate(rest);
      const Vector<Dim> g = gradients.col(j);
      jet.value += g.dot(u - corners[j == 0 ? 1 : 0]) * child.value;
      jet.gradient += degree * child.value * g;
      for (int a = 0; a < Dim; ++a) {
        for (int b = a; b < Dim; ++b) {
          jet.hessian[second_derivative_index<Dim>(a, b)] += degree * g[a] * child.gradient[b];
        }
      }
    }
    return jet;
  }
};

}  // namespace

template <int Dim>
SplineJet<Dim> simplex_spline(std::span<const Point<Dim>> knots, const Point<Dim>& u,
                              std::span<const Vector<Dim>> directions) {
  const int degree = static_cast<int>(knots.size()) - Dim - 1;
  if (degree < 0 || degree > kMaxDegree) {
    throw InvalidInput(message("simplex_spline: ", knots.size(), " knots in ", Dim,
                               "D make degree ", degree, "; give ", Dim + 1, " to ",
                               Dim + 1 + kMaxDegree, " knots."));
  }
  bool finite = u.allFinite();
  for (const auto& knot : knots) finite = finite && knot.allFinite();
  if (!finite) throw InvalidInput("simplex_spline: a knot or the point is not finite.");
  const Reference<Dim> reference{u, directions, kTie * diameter<Dim>(knots)};
  return reference.evaluate({knots.begin(), knots.end()});
}

template <int Dim>
std::vector<Vector<Dim>> flag_towards(const Point<Dim>& inside, const Point<Dim>& u) {
  Vector<Dim> first = inside - u;
  if (first.isZero(0.0)) first = Vector<Dim>::LinSpaced(1.0, 0.375);
  if constexpr (Dim == 2) {
    return {first, Vector<2>(-first[1], first[0])};
  } else {
    Vector<3>::Index smallest = 0;
    first.cwiseAbs().minCoeff(&smallest);
    const Vector<3> second = first.cross(Vector<3>(Vector<3>::Unit(smallest)));
    return {first, second, Vector<3>(first.cross(second))};
  }
}

template <int Dim>
SplitSet<Dim> largest_split_set(std::span<const Point<Dim>> knots) {
  SplitSet<Dim> best;
  std::array<int, Dim + 1> position;
  for (int j = 0; j <= Dim; ++j) position[j] = j;
  const int count = static_cast<int>(knots.size());
  while (true) {
    std::array<Point<Dim>, Dim + 1> corners;
    for (int j = 0; j <= Dim; ++j) corners[j] = knots[position[j]];
    const double determinant = signed_content<Dim>(corners);
    if (std::abs(determinant) > std::abs(best.determinant)) best = {position, determinant};
    int j = Dim;  // the next combination in lexicographic order
    while (j >= 0 && position[j] == count - 1 - Dim + j) --j;
    if (j < 0) break;
    ++position[j];
    for (int k = j + 1; k <= Dim; ++k) position[k] = position[k - 1] + 1;
  }
  const double scale = diameter<Dim>(knots);
  if (std::abs(best.determinant) < kNoVolume * std::pow(scale, Dim)) best.determinant = 0.0;
  return best;
}

template <int Dim>
Eigen::Matrix<double, Dim, Dim + 1> barycentric_gradients(
    const std::array<Point<Dim>, Dim + 1>& corners) {
  Matrix<Dim> edges;
  for (int a = 0; a < Dim; ++a) edges.col(a) = corners[a + 1] - corners[0];
  const Matrix<Dim> inverse = edges.inverse();
  Eigen::Matrix<double, Dim, Dim + 1> gradients;
  gradients.template rightCols<Dim>() = inverse.transpose();
  gradients.col(0) = -inverse.colwise().sum().transpose();
  return gradients;
}

template SplineJet<2> simplex_spline<2>(std::span<const Point<2>>, const Point<2>&,
                                        std::span<const Vector<2>>);
template SplineJet<3> simplex_spline<3>(std::span<const Point<3>>, const Point<3>&,
                                        std::span<const Vector<3>>);
template std::vector<Vector<2>> flag_towards<2>(const Point<2>&, const Point<2>&);
template std::vector<Vector<3>> flag_towards<3>(const Point<3>&, const Point<3>&);
template SplitSet<2> largest_split_set<2>(std::span<const Point<2>>);
template SplitSet<3> largest_split_set<3>(std::span<const Point<3>>);
template Eigen::Matrix<double, 2, 3> barycentric_gradients<2>(const std::array<Point<2>, 3>&);
template Eigen::Matrix<double, 3, 4> barycentric_gradients<3>(const std::array<Point<3>, 4>&);

}  // namespace crease

#include "Transforms/Splines/DeterminantPieces.h"

#include <algorithm>

namespace crease {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// De Casteljau's algorithm takes as many means in a row as the degree says.
double error_of_halves(double error, const Eigen::VectorXd& coefficients, int degree) {
  return error + degree * kEpsilon * coefficients.cwiseAbs().maxCoeff();
}

}  // namespace

template <int Dim>
double SimplexPiece<Dim>::size() const {
  double longest = 0;
  for (int j = 0; j <= Dim; ++j) {
    for (int k = 0; k < j; ++k) longest = std::max(longest, (points[j] - points[k]).norm());
  }
  return longest;
}

template <int Dim>
std::pair<SimplexPiece<Dim>, SimplexPiece<Dim>> SimplexPiece<Dim>::halves() const {
  int first = 0, second = 1;
  for (int j = 0; j <= Dim; ++j) {
    for (int k = 0; k < j; ++k) {
      if ((points[j] - points[k]).norm() > (points[first] - points[second]).norm()) {
        first = k;
        second = j;
      }
    }
  }
  auto [a, b] = determinant.split(first, second);
  const double after = error_of_halves(error, determinant.coefficients(), determinant.degree());
  const Point<Dim> middle = 0.5 * (points[first] + points[second]);
  std::pair<SimplexPiece, SimplexPiece> result = {{std::move(a), after, points},
                                                  {std::move(b), after, points}};
  result.first.points[second] = result.second.points[first] = middle;
  return result;
}

template <int Dim>
Point<Dim> BoxPiece<Dim>::corner(int j) const {
  Point<Dim> x = origin;
  for (int a = 0; a < Dim; ++a) {
    if (j >> a & 1) x += edges.col(a);
  }
  return x;
}

template <int Dim>
std::vector<Point<Dim>> BoxPiece<Dim>::corners() const {
  std::vector<Point<Dim>> all;
  for (int j = 0; j < kNumCorners; ++j) all.push_back(corner(Dim == 2 ? j ^ (j >> 1) : j));
  return all;
}

template <int Dim>
std::pair<BoxPiece<Dim>, BoxPiece<Dim>> BoxPiece<Dim>::halves() const {
  int axis = 0;
  for (int a = 1; a < Dim; ++a) {
    if (edges.col(a).norm() > edges.col(axis).norm()) axis = a;
  }
  auto [a, b] = determinant.split(axis);
  const double after =
      error_of_halves(error, determinant.coefficients(), determinant.degrees()[axis]);
  Matrix<Dim> halved = edges;
  halved.col(axis) *= 0.5;
  return {{std::move(a), after, origin, halved},
          {std::move(b), after, origin + halved.col(axis), halved}};
}

template <int Dim>
double determinant_error(double largest, double error) {
  constexpr double kProducts = Dim == 2 ? 2 : 6;
  const double others = Dim == 2 ? largest : largest * largest;
  return kProducts * others * (Dim * error + 256 * kEpsilon * largest);
}

template <int Dim>
SimplexPiece<Dim> simplex_piece(const std::array<Point<Dim>, Dim + 1>& corners, int degree,
                                std::span<const Matrix<Dim>> jacobians, double error) {
  const Eigen::MatrixXd& to_coefficients = coefficients_from_values<Dim>(degree);
  Eigen::Matrix<double, Eigen::Dynamic, Dim * Dim> values(std::ssize(jacobians), Dim * Dim);
  for (Eigen::Index p = 0; p < values.rows(); ++p) {
    values.row(p) = jacobians[p].reshaped().transpose();
  }
  const Eigen::Matrix<double, Eigen::Dynamic, Dim* Dim> c = to_coefficients * values;
  const double growth = to_coefficients.cwiseAbs().rowwise().sum().maxCoeff();
  const double of_coefficients = growth * (error + 2 * static_cast<double>(values.rows()) *
                                                       kEpsilon * values.cwiseAbs().maxCoeff());
  const auto entry = [&](int row, int column) {
    return BernsteinSimplex<Dim>(degree, c.col(Dim * column + row));
  };
  const auto minor = [&](int first, int second) {  // of the last two columns
    BernsteinSimplex<Dim> m = entry(first, Dim - 2) * entry(second, Dim - 1);
    m.coefficients() -= (entry(second, Dim - 2) * entry(first, Dim - 1)).coefficients();
    return m;
  };
  SimplexPiece<Dim> piece{
      minor(0, 1), determinant_error<Dim>(c.cwiseAbs().maxCoeff(), of_coefficients), corners};
  if constexpr (Dim == 3) {
    Eigen::VectorXd sum = (entry(0, 0) * minor(1, 2)).coefficients();
    sum += (entry(1, 0) * minor(2, 0)).coefficients();
    sum += (entry(2, 0) * minor(0, 1)).coefficients();
    piece.determinant = BernsteinSimplex<Dim>(3 * degree, std::move(sum));
  }
  return piece;
}

#define CREASE_INSTANTIATE(Dim)                                                              \
  template struct SimplexPiece<Dim>;                                                         \
  template struct BoxPiece<Dim>;                                                             \
  template double determinant_error<Dim>(double, double);                                    \
  template SimplexPiece<Dim> simplex_piece<Dim>(const std::array<Point<Dim>, Dim + 1>&, int, \
                                                std::span<const Matrix<Dim>>, double);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease

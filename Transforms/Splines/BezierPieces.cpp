#include "Transforms/Splines/BezierPieces.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace crease {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Of an ordinate, and of a coefficient of a product: sums of fewer than 256 positive terms.
constexpr double kSumError = 256 * std::numeric_limits<double>::epsilon();

/// A polynomial and its derivatives by t.
template <int Dim>
using Jet = std::vector<BernsteinBox<Dim>>;

template <int Dim>
BernsteinBox<Dim> derivative(const BernsteinBox<Dim>& p, int axis) {
  auto degrees = p.degrees();
  Eigen::Index stride = 1;
  for (int a = 0; a < axis; ++a) stride *= degrees[a] + 1;
  const int count = degrees[axis]--;
  const Eigen::Index outer = p.coefficients().size() / (stride * (count + 1));
  Eigen::VectorXd result(stride * count * outer);
  for (Eigen::Index o = 0; o < outer; ++o) {
    const auto lower = p.coefficients().segment(o * stride * (count + 1), stride * count);
    const auto upper = p.coefficients().segment(o * stride * (count + 1) + stride, stride * count);
    result.segment(o * stride * count, stride * count) = count * (upper - lower);
  }
  return {degrees, std::move(result)};
}

/// @param with_value  or the derivatives alone.
template <int Dim>
Jet<Dim> jet_of(int degree, Eigen::VectorXd coefficients, bool with_value) {
  std::array<int, Dim> degrees;
  degrees.fill(degree);
  const BernsteinBox<Dim> p(degrees, std::move(coefficients));
  Jet<Dim> jet;
  if (with_value) jet.push_back(p);
  for (int a = 0; a < Dim; ++a) jet.push_back(derivative<Dim>(p, a));
  return jet;
}

/// Of the rows, by the first one and the columns that are left.
template <int Dim>
BernsteinBox<Dim> determinant_of(std::span<const Jet<Dim>> rows, const std::vector<int>& columns) {
  if (rows.size() == 1) return rows[0][columns[0]];
  std::optional<BernsteinBox<Dim>> sum;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    std::vector<int> others = columns;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(c));
    BernsteinBox<Dim> term = rows[0][columns[c]] * determinant_of<Dim>(rows.subspan(1), others);
    if (c % 2 == 1) term.coefficients() = -term.coefficients();
    if (sum) {
      sum->coefficients() += term.coefficients();
    } else {
      sum = std::move(term);
    }
  }
  return *std::move(sum);
}

/// By how much rounding may change a coefficient of the determinant: a sum of k! products, one entry of each
/// column, those wrong by what their ordinates are wrong by.
template <int Dim>
double rounding_of(const std::vector<Jet<Dim>>& rows, double largest_ordinate, int degree) {
  const std::size_t k = rows.size();
  double products = 1, all = 1, wrong = 0;
  for (std::size_t c = 0; c < k; ++c) {
    double largest = 0;
    for (const auto& row : rows) {
      largest = std::max(largest, row[c].coefficients().cwiseAbs().maxCoeff());
    }
    const bool is_value = k > Dim && c == 0;
    const double error = kSumError * largest_ordinate * (is_value ? 1 : 2 * degree);
    wrong = wrong * (largest + error) + all * error;
    all *= largest;
    products *= static_cast<double>(c + 1);
  }
  return products * (wrong + static_cast<double>(k) * kSumError * all);
}

}  // namespace

template <int Dim>
BoxPiece<Dim> bezier_piece(const BezierBox<Dim>& box) {
  const bool rational = box.weights.size() > 0;
  // A map less a constant has the same determinant; numbers of the size of the box leave less rounding.
  ControlPoints<Dim> ordinates = box.ordinates;
  if (rational) {
    const Vector<Dim> middle = ordinates.rowwise().sum() / box.weights.sum();
    ordinates.noalias() -= middle * box.weights.transpose();
  } else {
    ordinates.colwise() -= Vector<Dim>(ordinates.rowwise().mean());
  }
  std::vector<Jet<Dim>> rows;
  const double scale = 1 / box.edges.determinant();
  if (rational) {
    const double largest = box.weights.maxCoeff();
    rows.push_back(jet_of<Dim>(box.degree, box.weights / largest, true));
    ordinates /= largest;
  }
  for (int a = 0; a < Dim; ++a) {
    rows.push_back(jet_of<Dim>(box.degree, ordinates.row(a).transpose(), rational));
  }
  std::vector<int> columns;
  for (int c = 0; c < static_cast<int>(rows.size()); ++c) columns.push_back(c);
  BernsteinBox<Dim> determinant = determinant_of<Dim>(rows, columns);
  determinant.coefficients() *= scale;
  const double largest = std::max(box.ordinates.cwiseAbs().maxCoeff(), rational ? 1.0 : 0.0);
  const double error = std::abs(scale) * rounding_of<Dim>(rows, largest, box.degree);
  return {std::move(determinant), error, box.origin, box.edges};
}

template <int Dim>
double BezierPieces<Dim>::rough_bound(int patch) const {
  return box_(patch) ? -kInfinity : kInfinity;
}

template <int Dim>
std::vector<DeterminantPiece<Dim>> BezierPieces<Dim>::pieces(int patch) const {
  const auto box = box_(patch);
  if (!box) return {};
  return {bezier_piece(*box)};
}

template BoxPiece<2> bezier_piece(const BezierBox<2>&);
template BoxPiece<3> bezier_piece(const BezierBox<3>&);
template class BezierPieces<2>;
template class BezierPieces<3>;

}  // namespace crease

#include "Transforms/Splines/TensorBSplinePieces.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace crease {
namespace {

/// Of an entry of a column: two subtractions, a division, and what makes Q.
constexpr double kColumnError = 16 * std::numeric_limits<double>::epsilon();

/// Of the columns and of what they are sums of.
template <int Dim>
double largest_entry(const std::array<ControlPoints<Dim>, Dim>& columns,
                     const Matrix<Dim>& linear) {
  double largest = 0;
  for (const auto& c : columns) largest = std::max(largest, c.cwiseAbs().maxCoeff());
  return largest + linear.cwiseAbs().maxCoeff();
}

/// det is linear in each column: on the hulls of two sets of columns it is nowhere below the least
/// determinant of a pair.
double least_determinant(const std::array<ControlPoints<2>, 2>& columns) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < columns[0].cols(); ++i) {
    const double x = columns[0](0, i), y = columns[0](1, i);
    for (Eigen::Index k = 0; k < columns[1].cols(); ++k) {
      least = std::min(least, x * columns[1](1, k) - y * columns[1](0, k));
    }
  }
  return least;
}

/// In space triples are many: with columns c_a + e_a, |e_a| <= r_a, det is det C plus the e_a . (c_b x c_c), whose
/// least values are known, plus what holds two or three e's, bounded by their lengths.
double least_determinant(const std::array<ControlPoints<3>, 3>& columns) {
  std::array<Vector<3>, 3> c;
  std::array<double, 3> r{};
  for (int a = 0; a < 3; ++a) {
    c[a] = 0.5 * (columns[a].rowwise().minCoeff() + columns[a].rowwise().maxCoeff());
    r[a] = (columns[a].colwise() - c[a]).colwise().norm().maxCoeff();
  }
  double least = c[0].cross(c[1]).dot(c[2]);
  for (int a = 0; a < 3; ++a) {
    const Vector<3> normal = c[(a + 1) % 3].cross(c[(a + 2) % 3]);
    least += (normal.transpose() * (columns[a].colwise() - c[a])).minCoeff();
  }
  const double two =
      r[0] * r[1] * c[2].norm() + r[1] * r[2] * c[0].norm() + r[2] * r[0] * c[1].norm();
  return least - two - r[0] * r[1] * r[2];
}

/// Applies a matrix along one axis of a field of values, first axis fastest.
template <int Dim>
Eigen::VectorXd along_axis(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& values,
                           const std::array<int, Dim>& degrees, int axis) {
  int stride = 1;
  for (int a = 0; a < axis; ++a) stride *= degrees[a] + 1;
  const int count = degrees[axis] + 1;
  Eigen::VectorXd result(values.size());
  for (Eigen::Index first = 0; first < values.size(); first += stride * count) {
    const Eigen::Map<const Eigen::MatrixXd> in(values.data() + first, stride, count);
    Eigen::Map<Eigen::MatrixXd>(result.data() + first, stride, count).noalias() =
        in.lazyProduct(matrix.transpose());
  }
  return result;
}

/// A column of F Q in Bernstein form, component by component.
template <int Dim>
std::array<Eigen::VectorXd, Dim> bernstein_column(const ControlPoints<Dim>& column,
                                                  const std::array<int, Dim>& degrees) {
  std::array<Eigen::VectorXd, Dim> components;
  for (int c = 0; c < Dim; ++c) {
    components[c] = column.row(c).transpose();
    for (int a = 0; a < Dim; ++a) {
      components[c] =
          along_axis<Dim>(bernstein_from_bspline(degrees[a]), components[c], degrees, a);
    }
  }
  return components;
}

}  // namespace

template <int Dim>
TensorBSplinePieces<Dim>::TensorBSplinePieces(const TensorLattice<Dim>& lattice, int degree,
                                              const ControlPoints<Dim>& phi,
                                              const Matrix<Dim>& linear)
    : lattice_(lattice), degree_(degree), phi_(phi) {
  const Matrix<Dim> q = lattice.direction.transpose().inverse();
  linear_ = linear * q;
  determinant_q_ = q.determinant();
}

template <int Dim>
int TensorBSplinePieces<Dim>::num_patches() const {
  int count = 1;
  for (int s : lattice_.spans) count *= s;
  return count;
}

template <int Dim>
std::array<ControlPoints<Dim>, Dim> TensorBSplinePieces<Dim>::columns(int patch) const {
  std::array<int, Dim> stride;  // of control points
  int corner = 0, next = 1;
  for (int a = 0; a < Dim; ++a) {
    stride[a] = next;
    corner += next * (patch % lattice_.spans[a]);
    patch /= lattice_.spans[a];
    next *= lattice_.spans[a] + degree_;
  }
  std::array<ControlPoints<Dim>, Dim> columns;
  for (int a = 0; a < Dim; ++a) {
    std::array<int, 3> count = {degree_ + 1, degree_ + 1, Dim == 3 ? degree_ + 1 : 1};
    --count[a];
    columns[a].resize(Dim, count[0] * count[1] * count[2]);
    Eigen::Index n = 0;
    for (int k = 0; k < count[2]; ++k) {
      for (int j = 0; j < count[1]; ++j) {
        const int row = corner + j * stride[1] + (Dim == 3 ? k * stride[Dim - 1] : 0);
        for (int i = 0; i < count[0]; ++i, ++n) {
          columns[a].col(n) = linear_.col(a) + (phi_.col(row + i + stride[a]) - phi_.col(row + i)) /
                                                   lattice_.spacing[a];
        }
      }
    }
  }
  return columns;
}

template <int Dim>
std::array<int, Dim> TensorBSplinePieces<Dim>::column_degrees(int axis) const {
  std::array<int, Dim> degrees;
  degrees.fill(degree_);
  --degrees[axis];
  return degrees;
}

template <int Dim>
double TensorBSplinePieces<Dim>::rough_bound(int patch) const {
  auto hulls = columns(patch);
  if (determinant_q_ < 0) hulls[0] = -hulls[0];
  const double largest = largest_entry<Dim>(hulls, linear_);
  const double rounding = determinant_error<Dim>(largest, 3 * kColumnError * largest);
  double least = least_determinant(hulls);
  if (Dim == 3 && least <= rounding) {  // Bernstein coefficients lie closer together
    for (int a = 0; a < Dim; ++a) {
      const auto components = bernstein_column<Dim>(hulls[a], column_degrees(a));
      for (int c = 0; c < Dim; ++c) hulls[a].row(c) = components[c].transpose();
    }
    least = least_determinant(hulls);
  }
  return (least - rounding) / std::abs(determinant_q_);
}

template <int Dim>
std::vector<DeterminantPiece<Dim>> TensorBSplinePieces<Dim>::pieces(int patch) const {
  const auto hulls = columns(patch);
  std::vector<std::vector<BernsteinBox<Dim>>> c(Dim);  // column, component
  for (int a = 0; a < Dim; ++a) {
    const auto degrees = column_degrees(a);
    for (auto& component : bernstein_column<Dim>(hulls[a], degrees)) {
      c[a].emplace_back(degrees, std::move(component));
    }
  }
  const auto minor = [&](int first, int second) {  // of the last two columns
    BernsteinBox<Dim> m = c[Dim - 2][first] * c[Dim - 1][second];
    m.coefficients() -= (c[Dim - 2][second] * c[Dim - 1][first]).coefficients();
    return m;
  };
  BernsteinBox<Dim> determinant = minor(0, 1);
  if constexpr (Dim == 3) {
    determinant = c[0][0] * minor(1, 2);
    determinant.coefficients() += (c[0][1] * minor(2, 0)).coefficients();
    determinant.coefficients() += (c[0][2] * minor(0, 1)).coefficients();
  }
  determinant.coefficients() /= determinant_q_;

  Vector<Dim> corner;
  for (int a = 0, rest = patch; a < Dim; ++a) {
    corner[a] = rest % lattice_.spans[a];
    rest /= lattice_.spans[a];
  }
  // Each axis' matrix takes up to 6 positive terms whose weights sum to 1.
  const double largest = largest_entry<Dim>(hulls, linear_), error = 3 * kColumnError * largest;
  return {BoxPiece<Dim>{
      std::move(determinant), determinant_error<Dim>(largest, error) / std::abs(determinant_q_),
      lattice_.point(corner), lattice_.direction * lattice_.spacing.asDiagonal()}};
}

template class TensorBSplinePieces<2>;
template class TensorBSplinePieces<3>;

}  // namespace crease

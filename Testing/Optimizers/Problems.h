#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "Optimizers/LinearConstraints.h"
#include "Optimizers/ObjectiveFunction.h"

namespace crease::testing {

inline Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index cols, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return uniform(random); });
}

inline Eigen::VectorXd random_vector(Eigen::Index size, std::mt19937& random) {
  return random_matrix(size, 1, random);
}

/// Landmarks of a uniform cubic tensor B-spline with side x side control points: each row has the 16
/// basis values at a random point, which sum to 1. Neighbouring landmarks overlap.
inline LinearConstraints landmark_constraints(int side, int count, int columns, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> position(0.0, side - 3.0);
  const auto basis = [](double t) {
    return std::array<double, 4>{(1 - t) * (1 - t) * (1 - t) / 6,
                                 (3 * t * t * t - 6 * t * t + 4) / 6,
                                 (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
  };
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < count; ++row) {
    const double x = position(random);
    const double y = position(random);
    const auto bx = basis(x - std::floor(x));
    const auto by = basis(y - std::floor(y));
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        const int point = (static_cast<int>(y) + j) * side + static_cast<int>(x) + i;
        entries.emplace_back(row, point,
                             bx[static_cast<std::size_t>(i)] * by[static_cast<std::size_t>(j)]);
      }
    }
  }
  LinearConstraints constraints;
  constraints.C.resize(count, side * side);
  constraints.C.setFromTriplets(entries.begin(), entries.end());
  constraints.d = 5.0 * random_matrix(count, columns, random);
  for (int row = 0; row < count; ++row)
    constraints.names.push_back("landmark " + std::to_string(row + 1));
  return constraints;
}

/// Appends rows: rows of `combination` (q x r) times the present ones, and shifts their right-hand sides.
inline void append_dependent_rows(LinearConstraints& constraints,
                                  const Eigen::MatrixXd& combination,
                                  const Eigen::MatrixXd& shift) {
  const Eigen::MatrixXd C = constraints.C;
  Eigen::MatrixXd all(C.rows() + combination.rows(), C.cols());
  all << C, combination * C;
  RowMatrix d(all.rows(), constraints.d.cols());
  d << constraints.d, combination * constraints.d + shift;
  constraints.C = all.sparseView();
  constraints.d = d;
  constraints.names.clear();
}

/// The lower triangle of a random positive definite matrix that couples unknowns of control points up to
/// `reach` rows and columns apart on a grid.
inline Eigen::SparseMatrix<double> grid_hessian(int side, int columns, int reach, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Eigen::Triplet<double>> entries;
  const int width = 2 * reach + 1;
  for (int p = 0; p < side * side; ++p) {
    for (int q = 0; q <= p; ++q) {
      if (std::abs(p / side - q / side) > reach || std::abs(p % side - q % side) > reach) continue;
      for (int a = 0; a < columns; ++a) {
        for (int b = 0; b < columns; ++b) {
          const int row = p * columns + a;
          const int column = q * columns + b;
          if (row < column) continue;
          // Diagonally dominant, hence positive definite.
          entries.emplace_back(
              row, column,
              row == column ? width * width * columns + uniform(random) : uniform(random));
        }
      }
    }
  }
  const int size = side * side * columns;
  Eigen::SparseMatrix<double> H(size, size);
  H.setFromTriplets(entries.begin(), entries.end());
  return H;
}

inline Eigen::MatrixXd dense_symmetric(const Eigen::SparseMatrix<double>& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

/// Convex and not quadratic: 1/2 x^T A x - b^T x + sum_i w log cosh(x_i).
class ConvexFunction final : public ObjectiveFunction {
 public:
  ConvexFunction(const Eigen::SparseMatrix<double>& A, Eigen::VectorXd b, double w)
      : A_(A), b_(std::move(b)), w_(w) {}
  Eigen::Index size() const override { return b_.size(); }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    ++evaluations;
    const Eigen::VectorXd Ax = A_.selfadjointView<Eigen::Lower>() * x;
    const Eigen::ArrayXd t = x.array().tanh();
    if (gradient != nullptr) *gradient = Ax - b_ + w_ * t.matrix();
    if (hessian != nullptr) {
      *hessian = A_;
      for (Eigen::Index i = 0; i < size(); ++i) hessian->coeffRef(i, i) += w_ * (1 - t[i] * t[i]);
    }
    return 0.5 * x.dot(Ax) - b_.dot(x) + w_ * x.array().cosh().log().sum();
  }
  int evaluations = 0;

 private:
  Eigen::SparseMatrix<double> A_;
  Eigen::VectorXd b_;
  double w_;
};

/// A function that offers a preconditioner.
class PreconditionedFunction final : public ObjectiveFunction {
 public:
  PreconditionedFunction(ObjectiveFunction& inner, const Eigen::SparseMatrix<double>& matrix)
      : inner_(inner), matrix_(matrix) {}
  Eigen::Index size() const override { return inner_.size(); }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    return inner_.evaluate(x, gradient, hessian);
  }
  bool preconditioner(const Eigen::Ref<const Eigen::VectorXd>&,
                      Eigen::SparseMatrix<double>& matrix) override {
    matrix = matrix_;
    return true;
  }

 private:
  ObjectiveFunction& inner_;
  Eigen::SparseMatrix<double> matrix_;
};

/// x - 0.1 log x, infinite beyond x = 0: its minimum, at 0.1, lies behind where long steps end.
class Barrier final : public ObjectiveFunction {
 public:
  Eigen::Index size() const override { return 1; }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    if (x[0] <= 0) {
      ++infinite;
      return std::numeric_limits<double>::infinity();
    }
    if (gradient != nullptr) *gradient = Eigen::VectorXd::Constant(1, 1 - 0.1 / x[0]);
    if (hessian != nullptr) {
      hessian->resize(1, 1);
      hessian->coeffRef(0, 0) = 0.1 / (x[0] * x[0]);
    }
    return x[0] - 0.1 * std::log(x[0]);
  }
  int infinite = 0;  ///< trial points beyond
};

/// 1/2 |r(x)|^2 with the Gauss-Newton Hessian J^T J, dense.
class ResidualFunction : public ObjectiveFunction {
 public:
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    const Eigen::VectorXd r = residuals(x);
    if (gradient != nullptr || hessian != nullptr) {
      const Eigen::MatrixXd J = jacobian(x);
      if (gradient != nullptr) *gradient = J.transpose() * r;
      if (hessian != nullptr) {
        const Eigen::MatrixXd H = (J.transpose() * J).triangularView<Eigen::Lower>();
        hessian->resize(size(), size());
        std::vector<Eigen::Triplet<double>> entries;
        for (int j = 0; j < size(); ++j) {
          for (int i = j; i < size(); ++i) entries.emplace_back(i, j, H(i, j));
        }
        hessian->setFromTriplets(entries.begin(), entries.end());
      }
    }
    return 0.5 * r.squaredNorm();
  }
  virtual Eigen::VectorXd residuals(const Eigen::VectorXd& x) const = 0;
  virtual Eigen::MatrixXd jacobian(const Eigen::VectorXd& x) const = 0;
};

/// Rosenbrock's valley: r = (10 (x1 - x0^2), 1 - x0), minimum 0 at (1, 1).
class Rosenbrock final : public ResidualFunction {
 public:
  Eigen::Index size() const override { return 2; }
  Eigen::VectorXd residuals(const Eigen::VectorXd& x) const override {
    return Eigen::Vector2d(10 * (x[1] - x[0] * x[0]), 1 - x[0]);
  }
  Eigen::MatrixXd jacobian(const Eigen::VectorXd& x) const override {
    return (Eigen::Matrix2d() << -20 * x[0], 10, -1, 0).finished();
  }
};

/// r = sin(A x) + A x - t with t = sin(A x*) + A x*: zero at x*.
class SineResiduals final : public ResidualFunction {
 public:
  SineResiduals(Eigen::MatrixXd A, const Eigen::VectorXd& solution)
      : A_(std::move(A)), t_((A_ * solution).array().sin().matrix() + A_ * solution) {}
  Eigen::Index size() const override { return A_.cols(); }
  Eigen::VectorXd residuals(const Eigen::VectorXd& x) const override {
    return (A_ * x).array().sin().matrix() + A_ * x - t_;
  }
  Eigen::MatrixXd jacobian(const Eigen::VectorXd& x) const override {
    return (1.0 + (A_ * x).array().cos()).matrix().asDiagonal() * A_;
  }

 private:
  Eigen::MatrixXd A_;
  Eigen::VectorXd t_;
};

/// max |C Phi - d| for a stacked Phi.
inline double violation(const LinearConstraints& constraints, const Eigen::VectorXd& x) {
  if (constraints.num_rows() == 0) return 0.0;
  const Eigen::Index k = constraints.d.cols();
  const Eigen::Map<const RowMatrix> phi(x.data(), x.size() / k, k);
  return (constraints.C * phi - constraints.d).cwiseAbs().maxCoeff();
}

}  // namespace crease::testing

#pragma once

#include <Eigen/SparseCore>
#include <span>

#include "Transforms/BlockHessian.h"

namespace crease {

/// phi -> 1/2 sum over coordinates j of phi_j^T K phi_j: a quadratic energy that treats all coordinates
/// alike. K is n x n, symmetric positive semi-definite.
template <int Dim>
class QuadraticForm {
 public:
  explicit QuadraticForm(const Eigen::SparseMatrix<double>& matrix) : matrix_(matrix) {}

  const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }
  /// As Energy::evaluate.
  double evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                  ControlPoints<Dim>* gradient, BlockHessian<Dim>* hessian) const;
  /// As Energy::add_stiffness.
  void add_stiffness(double scale, const HessianPattern& pattern,
                     std::span<double> stiffness) const;

 private:
  Eigen::SparseMatrix<double> matrix_;
};

extern template class QuadraticForm<2>;
extern template class QuadraticForm<3>;

}  // namespace crease

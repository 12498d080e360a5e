#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <vector>

namespace crease {

/// Rows of coefficients, one run of memory per row: entry (i, a) of an m x k matrix lies at k * i + a.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// r linear equations C Phi = d on the m x k unknowns Phi.
///
/// Position landmarks: C is scalar (C(j, i) = B_i(p_j)) and serves all k = Dim columns of Phi at once,
/// d = q - A(p). Equations that couple coordinates: Phi is the stacked vector, m = Dim * n, k = 1.
/// The optimizers' vector x stacks Phi by rows, x[k * i + a] = Phi(i, a): control point after control
/// point.
///
/// Source: registration by B-splines with landmarks, equation (3.8): C Phi = Q - A(P).
struct LinearConstraints {
  Eigen::SparseMatrix<double, Eigen::RowMajor> C;  ///< r x m
  RowMatrix d;                                     ///< r x k
  std::vector<std::string> names;  ///< one per row, for messages ("landmark 12"); or empty

  Eigen::Index num_rows() const { return C.rows(); }
  /// The name of a row, "constraint 3" where none was given.
  std::string name(Eigen::Index row) const;
};

/// No constraint at all on m x k unknowns.
LinearConstraints no_constraints(Eigen::Index m, Eigen::Index k = 1);

/// @throws InvalidInput when C, d and the names differ in their number of rows, C has not m columns,
/// d has no column, or an entry of C or d is not finite; the message names the row.
void check_constraints(const LinearConstraints& constraints, Eigen::Index m);

}  // namespace crease

#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "Optimizers/LinearConstraints.h"

namespace crease {

/// The reduced row echelon form of C Phi = d: Phi(p, :) = rhs - R Phi(f, :) for the pivot columns p.
struct GaussJordanForm {
  std::vector<int> pivot_columns;   ///< p, one per independent row, in the order of elimination
  std::vector<int> pivot_rows;      ///< the row of C that was reduced to it
  std::vector<int> dependent_rows;  ///< rows of C of which nothing was left
  /// Row i of R: columns of C (all free) with their coefficients, ascending.
  std::vector<std::vector<std::pair<int, double>>> R;
  RowMatrix rhs;  ///< rank x k
};

/// Gauss-Jordan elimination with complete pivoting by row choice. Rows are scaled to max |c| = 1; among
/// the remaining rows the one whose largest remaining entry is largest is the next pivot row, that entry
/// the pivot; its column is then eliminated from every other row that contains it. Rows that fall
/// below `tolerance` of their original scale are dependent. Only columns that occur in C are touched.
GaussJordanForm gauss_jordan(const LinearConstraints& constraints, double tolerance = 1e-9);

}  // namespace crease

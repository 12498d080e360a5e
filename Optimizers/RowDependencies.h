#pragma once

#include <span>
#include <vector>

#include "Optimizers/LinearConstraints.h"

namespace crease {

/// A row of C that is a combination of other rows: c_j = sum_i weights[i] c_{depends_on[i]}.
struct DependentRow {
  int row = 0;
  std::vector<int> depends_on;  ///< independent rows, ascending; empty for a row of zeros
  std::vector<double> weights;  ///< of the rows above
  /// rho = d_j - sum_i weights[i] d_{depends_on[i]}: what is left of the right-hand side (k numbers,
  /// unit of d). Zero: the row follows from the others. Not zero: it contradicts them.
  Eigen::VectorXd residual;
};

/// Expresses each dependent row by the independent ones (a sparse QR factorisation of these; nothing
/// is done when there is no dependent row).
std::vector<DependentRow> express_dependent_rows(const LinearConstraints& constraints,
                                                 std::span<const int> independent,
                                                 std::span<const int> dependent);

}  // namespace crease

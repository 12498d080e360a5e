#include "Optimizers/LinearConstraints.h"

#include <cmath>

#include "Core/Error.h"

namespace crease {

std::string LinearConstraints::name(Eigen::Index row) const {
  return names.empty() ? message("constraint ", row) : names[static_cast<std::size_t>(row)];
}

LinearConstraints no_constraints(Eigen::Index m, Eigen::Index k) {
  LinearConstraints constraints;
  constraints.C.resize(0, m);
  constraints.d.resize(0, k);
  return constraints;
}

void check_constraints(const LinearConstraints& constraints, Eigen::Index m) {
  const auto& [C, d, names] = constraints;
  if (C.rows() != d.rows()) {
    throw InvalidInput(message("linear constraints: C has ", C.rows(), " rows and d has ", d.rows(),
                               "; give each row of C its right-hand side."));
  }
  if (!names.empty() && static_cast<Eigen::Index>(names.size()) != C.rows()) {
    throw InvalidInput(message("linear constraints: ", names.size(), " names for ", C.rows(),
                               " rows; give one name per row, or none."));
  }
  if (C.cols() != m) {
    throw InvalidInput(message("linear constraints: C has ", C.cols(), " columns, but there are ",
                               m, " rows of unknowns; build C for the same control points."));
  }
  if (d.cols() < 1) {
    throw InvalidInput("linear constraints: d has no column; it needs one per column of unknowns.");
  }
  for (Eigen::Index j = 0; j < C.rows(); ++j) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(C, j); entry; ++entry) {
      if (!std::isfinite(entry.value())) {
        throw InvalidInput(message("linear constraints: the coefficient of ", constraints.name(j),
                                   " at column ", entry.col(), " is ", entry.value(),
                                   "; give a finite number."));
      }
    }
    if (!d.row(j).allFinite()) {
      throw InvalidInput(message("linear constraints: the right-hand side of ", constraints.name(j),
                                 " is (", d.row(j), "); give finite numbers."));
    }
  }
}

}  // namespace crease

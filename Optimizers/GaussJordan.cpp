#include "Optimizers/GaussJordan.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace crease {
namespace {

using Entry = std::pair<int, double>;  // column, coefficient
using Row = std::vector<Entry>;        // ascending columns

// A difference this small relative to its operands is rounding and leaves the row.
constexpr double kCancelled = 1e-15;

double largest(const Row& row, int* column = nullptr) {
  double max = 0.0;
  for (const auto& [j, value] : row) {
    if (std::abs(value) > max) {
      max = std::abs(value);
      if (column != nullptr) *column = j;
    }
  }
  return max;
}

double coefficient(const Row& row, int column) {
  const auto at = std::lower_bound(row.begin(), row.end(), column,
                                   [](const Entry& e, int j) { return e.first < j; });
  return at != row.end() && at->first == column ? at->second : 0.0;
}

class Elimination {
 public:
  Elimination(const LinearConstraints& constraints, double tolerance);
  GaussJordanForm run();

 private:
  int next_pivot_row() const;
  void eliminate(int pivot_row, int column);
  void subtract(int row, double factor, int pivot_row, int pivot_column);

  double tolerance_;
  std::vector<Row> rows_;
  RowMatrix rhs_;
  std::vector<double> largest_;              // of each remaining row; -1 for pivot rows
  std::vector<std::vector<int>> in_column_;  // rows that contain a column, and some that did
};

Elimination::Elimination(const LinearConstraints& constraints, double tolerance)
    : tolerance_(tolerance),
      rhs_(constraints.d),
      in_column_(static_cast<std::size_t>(constraints.C.cols())) {
  for (int i = 0; i < constraints.C.rows(); ++i) {
    Row row;
    for (decltype(constraints.C)::InnerIterator entry(constraints.C, i); entry; ++entry) {
      if (entry.value() != 0.0) row.emplace_back(static_cast<int>(entry.col()), entry.value());
    }
    const double scale = largest(row);
    for (auto& [j, value] : row) {
      value /= scale;
      in_column_[static_cast<std::size_t>(j)].push_back(i);
    }
    if (scale > 0.0) rhs_.row(i) /= scale;
    rows_.push_back(std::move(row));
    largest_.push_back(scale > 0.0 ? 1.0 : 0.0);
  }
}

int Elimination::next_pivot_row() const {
  const auto best = std::max_element(largest_.begin(), largest_.end());
  return best == largest_.end() || *best < tolerance_ ? -1
                                                      : static_cast<int>(best - largest_.begin());
}

void Elimination::eliminate(int pivot_row, int column) {
  Row& row = rows_[static_cast<std::size_t>(pivot_row)];
  const double pivot = coefficient(row, column);
  for (auto& entry : row) entry.second = entry.first == column ? 1.0 : entry.second / pivot;
  rhs_.row(pivot_row) /= pivot;
  largest_[static_cast<std::size_t>(pivot_row)] = -1.0;
  std::vector<int> others = std::move(in_column_[static_cast<std::size_t>(column)]);
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  for (int other : others) {
    if (other == pivot_row) continue;
    const double factor = coefficient(rows_[static_cast<std::size_t>(other)], column);
    if (factor != 0.0) subtract(other, factor, pivot_row, column);
  }
}

// row -= factor * pivot row, exactly zero in the pivot column.
void Elimination::subtract(int row, double factor, int pivot_row, int pivot_column) {
  Row& target = rows_[static_cast<std::size_t>(row)];
  const Row& source = rows_[static_cast<std::size_t>(pivot_row)];
  Row sum;
  sum.reserve(target.size() + source.size());
  auto a = target.begin();
  for (const auto& [j, value] : source) {
    for (; a != target.end() && a->first < j; ++a) sum.push_back(*a);
    const bool present = a != target.end() && a->first == j;
    const double old = present ? a->second : 0.0;
    const double change = factor * value;
    if (present) ++a;
    if (j == pivot_column ||
        std::abs(old - change) <= kCancelled * std::max(std::abs(old), std::abs(change))) {
      continue;
    }
    if (!present) in_column_[static_cast<std::size_t>(j)].push_back(row);
    sum.emplace_back(j, old - change);
  }
  sum.insert(sum.end(), a, target.end());
  target = std::move(sum);
  rhs_.row(row) -= factor * rhs_.row(pivot_row);
  double& max = largest_[static_cast<std::size_t>(row)];
  if (max >= 0.0) max = largest(target);
}

GaussJordanForm Elimination::run() {
  GaussJordanForm form;
  for (int row = next_pivot_row(); row >= 0; row = next_pivot_row()) {
    int column = 0;
    largest(rows_[static_cast<std::size_t>(row)], &column);
    eliminate(row, column);
    form.pivot_rows.push_back(row);
    form.pivot_columns.push_back(column);
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (largest_[i] >= 0.0) form.dependent_rows.push_back(static_cast<int>(i));
  }
  const auto rank = static_cast<Eigen::Index>(form.pivot_rows.size());
  form.rhs.resize(rank, rhs_.cols());
  for (Eigen::Index i = 0; i < rank; ++i) {
    const auto row = static_cast<std::size_t>(form.pivot_rows[static_cast<std::size_t>(i)]);
    form.rhs.row(i) = rhs_.row(static_cast<Eigen::Index>(row));
    std::erase_if(rows_[row], [&](const Entry& entry) {
      return entry.first == form.pivot_columns[static_cast<std::size_t>(i)];
    });
    form.R.push_back(std::move(rows_[row]));
  }
  return form;
}

}  // namespace

GaussJordanForm gauss_jordan(const LinearConstraints& constraints, double tolerance) {
  return Elimination(constraints, tolerance).run();
}

}  // namespace crease

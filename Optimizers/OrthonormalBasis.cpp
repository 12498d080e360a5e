#include "Optimizers/OrthonormalBasis.h"

#include <utility>

namespace crease {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// H's touched rows, one dense t x columns matrix per component a: first the columns of the touched
// unknowns (k t), then those untouched ones that are coupled to them.
struct Strips {
  Strips(const TouchedRows& rows, Eigen::Index k, const Sparse& H);
  std::vector<Eigen::MatrixXd> of_component;
  std::vector<int> coupled;  // per untouched unknown: its column in the strips, or -1
};

template <typename Visit>
void for_each_lower(const Sparse& H, Visit&& visit) {
  for (int j = 0; j < H.outerSize(); ++j) {
    for (Sparse::InnerIterator entry(H, j); entry; ++entry) {
      if (entry.row() >= j) visit(static_cast<int>(entry.row()), j, entry.value());
    }
  }
}

Strips::Strips(const TouchedRows& rows, Eigen::Index k, const Sparse& H)
    : coupled(rows.untouched.size() * static_cast<std::size_t>(k), -1) {
  const auto block = static_cast<int>(k);
  const auto touched = [&](int i) { return rows.is_touched[static_cast<std::size_t>(i / block)]; };
  const auto unknown = [&](int i) {
    return rows.position[static_cast<std::size_t>(i / block)] * block + i % block;
  };
  auto num_columns = static_cast<int>(rows.touched.size()) * block;
  for_each_lower(H, [&](int i, int j, double) {
    if (touched(i) == touched(j)) return;
    int& column = coupled[static_cast<std::size_t>(unknown(touched(i) ? j : i))];
    if (column < 0) column = num_columns++;
  });
  of_component.assign(
      static_cast<std::size_t>(k),
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.touched.size()), num_columns));
  const auto put = [&](int i, int j, double value) {
    if (!touched(i)) return;
    const int column = touched(j) ? unknown(j) : coupled[static_cast<std::size_t>(unknown(j))];
    of_component[static_cast<std::size_t>(i % block)](unknown(i) / block, column) = value;
  };
  for_each_lower(H, [&](int i, int j, double value) {
    put(i, j, value);
    put(j, i, value);
  });
}

// turned[a](:, b + k q) = (N_T^T H_ab N_T)(:, q), from strips that are turned from the left.
std::vector<Eigen::MatrixXd> turn_from_right(const std::vector<Eigen::MatrixXd>& strips,
                                             Eigen::Index t, Eigen::Index num_turned,
                                             const OrthonormalBasis::Action& apply_transpose) {
  const auto k = static_cast<Eigen::Index>(strips.size());
  std::vector<Eigen::MatrixXd> turned(strips.size(), Eigen::MatrixXd(num_turned, k * num_turned));
  for (std::size_t a = 0; a < strips.size(); ++a) {
    for (Eigen::Index b = 0; b < k; ++b) {
      Eigen::MatrixXd columns(num_turned, t);
      for (Eigen::Index i = 0; i < t; ++i) columns.col(i) = strips[a].col(i * k + b);
      const Eigen::MatrixXd product = apply_transpose(columns.transpose());
      for (Eigen::Index q = 0; q < num_turned; ++q) {
        turned[a].col(q * k + b) = product.row(q).transpose();
      }
    }
  }
  return turned;
}

// H among untouched unknowns, in their new numbers, diagonal always included.
std::vector<Eigen::Triplet<double>> untouched_entries(const TouchedRows& rows, int block,
                                                      const Sparse& H) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto num_untouched = static_cast<int>(rows.untouched.size()) * block;
  for (int y = 0; y < num_untouched; ++y) entries.emplace_back(y, y, 0.0);
  const auto unknown = [&](int i) {  // of Y, or -1 for touched ones
    const auto row = static_cast<std::size_t>(i / block);
    return rows.is_touched[row] ? -1 : rows.position[row] * block + i % block;
  };
  for_each_lower(H, [&](int i, int j, double value) {
    const int p = unknown(i);
    const int q = unknown(j);
    if (p >= 0 && q >= 0) entries.emplace_back(p, q, value);
  });
  return entries;
}

}  // namespace

OrthonormalBasis::OrthonormalBasis(TouchedRows rows, Eigen::Index k, Eigen::Index num_turned,
                                   Action turn, Action turn_back)
    : rows_(std::move(rows)),
      k_(k),
      num_turned_(num_turned),
      turn_(std::move(turn)),
      turn_back_(std::move(turn_back)) {}

Eigen::VectorXd OrthonormalBasis::apply(const Eigen::Ref<const Eigen::VectorXd>& y) const {
  const auto t = static_cast<Eigen::Index>(rows_.touched.size());
  const auto num_untouched = static_cast<Eigen::Index>(rows_.untouched.size());
  Eigen::VectorXd phi(k_ * (t + num_untouched));
  for (Eigen::Index i = 0; i < num_untouched; ++i) {
    phi.segment(k_ * rows_.untouched[static_cast<std::size_t>(i)], k_) = y.segment(k_ * i, k_);
  }
  const Eigen::Map<const RowMatrix> tail(y.data() + k_ * num_untouched, num_turned_, k_);
  const Eigen::MatrixXd turned = turn_(tail);
  for (Eigen::Index i = 0; i < t; ++i) {
    phi.segment(k_ * rows_.touched[static_cast<std::size_t>(i)], k_) = turned.row(i).transpose();
  }
  return phi;
}

Eigen::VectorXd OrthonormalBasis::apply_transpose(
    const Eigen::Ref<const Eigen::VectorXd>& g) const {
  const auto t = static_cast<Eigen::Index>(rows_.touched.size());
  const auto num_untouched = static_cast<Eigen::Index>(rows_.untouched.size());
  Eigen::VectorXd y(k_ * (num_untouched + num_turned_));
  for (Eigen::Index i = 0; i < num_untouched; ++i) {
    y.segment(k_ * i, k_) = g.segment(k_ * rows_.untouched[static_cast<std::size_t>(i)], k_);
  }
  Eigen::MatrixXd touched(t, k_);
  for (Eigen::Index i = 0; i < t; ++i) {
    touched.row(i) = g.segment(k_ * rows_.touched[static_cast<std::size_t>(i)], k_).transpose();
  }
  Eigen::Map<RowMatrix>(y.data() + k_ * num_untouched, num_turned_, k_) = turn_back_(touched);
  return y;
}

void OrthonormalBasis::reduce(const Sparse& H, Eigen::Index k, Sparse& reduced) const {
  Strips strips(rows_, k, H);
  for (auto& strip : strips.of_component) strip = turn_back_(strip);
  const auto corner =
      turn_from_right(strips.of_component, static_cast<Eigen::Index>(rows_.touched.size()),
                      num_turned_, turn_back_);
  const auto block = static_cast<int>(k);
  const auto num_untouched = static_cast<int>(rows_.untouched.size()) * block;
  auto entries = untouched_entries(rows_, block, H);
  for (int n = 0; n < static_cast<int>(num_turned_) * block; ++n) {  // the new coordinates' rows
    const int row = num_untouched + n;
    const auto component = static_cast<std::size_t>(n % block);
    for (int y = 0; y < num_untouched; ++y) {
      const int column = strips.coupled[static_cast<std::size_t>(y)];
      if (column < 0) continue;
      entries.emplace_back(row, y, strips.of_component[component](n / block, column));
    }
    for (int other = 0; other <= n; ++other) {
      entries.emplace_back(row, num_untouched + other, corner[component](n / block, other));
    }
  }
  const Eigen::Index size = num_untouched + num_turned_ * k;
  reduced.resize(size, size);
  reduced.setFromTriplets(entries.begin(), entries.end());
}

}  // namespace crease

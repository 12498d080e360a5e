#include "Optimizers/TouchedRows.h"

#include <algorithm>
#include <cmath>

namespace crease {

TouchedRows::TouchedRows(const Eigen::SparseMatrix<double, Eigen::RowMajor>& C)
    : position(static_cast<std::size_t>(C.cols())), is_touched(position.size(), false) {
  for (int i = 0; i < C.outerSize(); ++i) {
    for (std::decay_t<decltype(C)>::InnerIterator entry(C, i); entry; ++entry) {
      if (entry.value() != 0.0) is_touched[static_cast<std::size_t>(entry.col())] = true;
    }
  }
  for (std::size_t i = 0; i < position.size(); ++i) {
    auto& list = is_touched[i] ? touched : untouched;
    position[i] = static_cast<int>(list.size());
    list.push_back(static_cast<int>(i));
  }
}

Eigen::SparseMatrix<double> TouchedRows::scaled(
    const Eigen::SparseMatrix<double, Eigen::RowMajor>& C, Eigen::VectorXd& scales) const {
  scales.setOnes(C.rows());
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < C.outerSize(); ++i) {
    double scale = 0.0;
    for (std::decay_t<decltype(C)>::InnerIterator entry(C, i); entry; ++entry) {
      scale = std::max(scale, std::abs(entry.value()));
    }
    if (scale == 0.0) continue;
    scales[i] = scale;
    for (std::decay_t<decltype(C)>::InnerIterator entry(C, i); entry; ++entry) {
      if (entry.value() == 0.0) continue;
      entries.emplace_back(i, position[static_cast<std::size_t>(entry.col())],
                           entry.value() / scale);
    }
  }
  Eigen::SparseMatrix<double> result(C.rows(), static_cast<Eigen::Index>(touched.size()));
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace crease

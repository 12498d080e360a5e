#include "Registration/Phantoms/ThinPlateMap.h"

#include <Eigen/LU>
#include <cmath>

#include "Core/Error.h"

namespace crease {
namespace {

// r^2 log r from r^2.
double kernel(double r2) { return r2 > 0 ? 0.5 * r2 * std::log(r2) : 0; }

}  // namespace

ThinPlateMap::ThinPlateMap(std::span<const Point<2>> from, std::span<const Point<2>> to)
    : from_(from.begin(), from.end()) {
  const auto n = static_cast<Eigen::Index>(from_.size());
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + 3, n + 3);
  Eigen::MatrixXd target = Eigen::MatrixXd::Zero(n + 3, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k) system(i, k) = kernel((from_[i] - from_[k]).squaredNorm());
    system.block<1, 3>(i, n) << from_[i].x(), from_[i].y(), 1;
    system.block<3, 1>(n, i) << from_[i].x(), from_[i].y(), 1;
    target.row(i) = to[i].transpose();
  }
  const Eigen::MatrixXd solution = system.partialPivLu().solve(target);
  if (!solution.allFinite() || !(system * solution).isApprox(target, 1e-8)) {
    throw SolverError(message("ThinPlateMap: the ", n,
                              " points coincide or lie on one line; the system is singular"));
  }
  for (Eigen::Index i = 0; i < n; ++i) weights_.emplace_back(solution.row(i).transpose());
  affine_.linear = solution.block<2, 2>(n, 0).transpose();
  affine_.offset = solution.row(n + 2).transpose();
}

Point<2> ThinPlateMap::operator()(const Point<2>& x) const {
  Point<2> y = affine_(x);
  for (std::size_t i = 0; i < from_.size(); ++i) {
    y += kernel((x - from_[i]).squaredNorm()) * weights_[i];
  }
  return y;
}

}  // namespace crease

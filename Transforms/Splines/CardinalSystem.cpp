#include "Transforms/Splines/CardinalSystem.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "Core/Error.h"

namespace crease {
namespace {

constexpr double kDistinct = 1e-9;  // of the centres' extent

/// Throws for two centres nearer than kDistinct; sorted along the first axis, few pairs are looked at.
template <int Dim>
void refuse_duplicates(std::string_view owner, const ControlPoints<Dim>& centres,
                       const ControlPoints<Dim>& local) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(local.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](Eigen::Index i) { return local(0, i); });
  for (std::size_t a = 0; a < order.size(); ++a) {
    for (std::size_t b = a + 1; b < order.size(); ++b) {
      if (local(0, order[b]) - local(0, order[a]) > kDistinct) break;
      if ((local.col(order[a]) - local.col(order[b])).norm() > kDistinct) continue;
      const auto [i, k] = std::minmax(order[a], order[b]);
      throw InvalidInput(message(owner, ": the centres ", i, " and ", k, " coincide at (",
                                 centres.col(i).transpose(), ") mm; leave one of them out."));
    }
  }
}

}  // namespace

CardinalSystem::CardinalSystem(const Eigen::MatrixXd& K, const Eigen::MatrixXd& P) {
  const Eigen::Index m = P.rows(), q = P.cols(), free = m - q;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(P);
  const auto Q = qr.householderQ();
  Eigen::MatrixXd turned = K;  // Q^T K Q
  turned.applyOnTheLeft(Q.adjoint());
  turned.applyOnTheRight(Q);
  const Eigen::LLT<Eigen::MatrixXd> factor(turned.bottomRightCorner(free, free));
  // The smallest pivot that rounding leaves trustworthy.
  if (factor.info() != Eigen::Success || !turned.allFinite() ||
      (free > 0 && !(factor.rcond() > 1e-14))) {
    throw SolverError(message("the interpolation system of ", m,
                              " unknowns is singular to rounding: some centres nearly coincide; "
                              "leave one of each such pair out."));
  }
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(free, free));
  E = Eigen::MatrixXd::Zero(m, m);
  E.bottomRightCorner(free, free) = 0.5 * (inverse + inverse.transpose());
  E.applyOnTheLeft(Q);
  E.applyOnTheRight(Q.adjoint());
  E = (0.5 * (E + E.transpose())).eval();
  A.setZero(q, m);
  A.leftCols(q).setIdentity();
  A.rightCols(free) = -turned.topRightCorner(q, free) * inverse;
  A.applyOnTheRight(Q.adjoint());
  qr.matrixQR().topRows(q).triangularView<Eigen::Upper>().solveInPlace(A);
}

template <int Dim>
CentreFrame<Dim>::CentreFrame(std::string_view owner, const ControlPoints<Dim>& centres) {
  const Eigen::Index n = centres.cols();
  if (n < Dim + 1 || n > kMostCentres) {
    throw InvalidInput(
        message(owner, ": ", n, " centres; ", Dim + 1, " to ", kMostCentres, " are possible."));
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!centres.col(i).allFinite()) {
      throw InvalidInput(message(owner, ": the centre ", i, " at (", centres.col(i).transpose(),
                                 ") mm is not finite."));
    }
  }
  mean = centres.rowwise().mean();
  points = centres.colwise() - mean;
  length = points.colwise().norm().maxCoeff();
  if (!(length > 0)) throw InvalidInput(message(owner, ": the centres all coincide."));
  points /= length;
  const Eigen::JacobiSVD<Eigen::MatrixXd> spread(points);
  if (!(spread.singularValues()[Dim - 1] > kDistinct * spread.singularValues()[0])) {
    throw InvalidInput(message(owner, ": the ", n, " centres lie on one ",
                               Dim == 2 ? "line" : "plane", "; add one off it."));
  }
  refuse_duplicates<Dim>(owner, centres, points);
}

template <int Dim>
double mean_centre_distance(const Box<Dim>& box, Eigen::Index n) {
  // n points of a regular lattice with its border: (n^(1/Dim) - 1)^Dim cells.
  const double cells = std::max(1.0, std::pow(double(n), 1.0 / Dim) - 1);
  return std::pow(box.size().prod(), 1.0 / Dim) / cells;
}

template struct CentreFrame<2>;
template struct CentreFrame<3>;
template double mean_centre_distance(const Box<2>&, Eigen::Index);
template double mean_centre_distance(const Box<3>&, Eigen::Index);

}  // namespace crease

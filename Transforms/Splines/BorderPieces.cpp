#include "Transforms/Splines/BorderPieces.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace crease {
namespace {

constexpr double kShortest = 1e-7;  // piece, of the edge's length

/// Chebyshev's nodes in (0, 1).
Eigen::VectorXd nodes_within(int count) {
  Eigen::VectorXd nodes(count);
  for (int k = 0; k < count; ++k) {
    nodes[k] = 0.5 - 0.5 * std::cos((k + 0.5) * std::numbers::pi / count);
  }
  return nodes;
}

/// Column k: the powers 0 .. count - 1 of node k.
Eigen::MatrixXd powers_of(const Eigen::VectorXd& nodes) {
  Eigen::MatrixXd powers(nodes.size(), nodes.size());
  for (Eigen::Index k = 0; k < nodes.size(); ++k) {
    for (Eigen::Index m = 0; m < nodes.size(); ++m) {
      powers(m, k) = std::pow(nodes[k], static_cast<double>(m));
    }
  }
  return powers;
}

}  // namespace

BorderPieces::BorderPieces(std::vector<double> breaks, int degree, const Evaluation& evaluate) {
  std::ranges::sort(breaks);
  starts_ = {0.0};
  for (double s : breaks) {
    if (s - starts_.back() > kShortest && 1 - s > kShortest) starts_.push_back(s);
  }
  const Eigen::VectorXd nodes = nodes_within(degree + 1);
  std::vector<double> parameters;
  for (std::size_t k = 0; k < starts_.size(); ++k) {
    const double end = k + 1 < starts_.size() ? starts_[k + 1] : 1.0;
    for (double node : nodes) parameters.push_back(starts_[k] + node * (end - starts_[k]));
  }
  const Eigen::MatrixXd values = evaluate(parameters);
  const Eigen::MatrixXd to_powers = powers_of(nodes).inverse();
  for (std::size_t k = 0; k < starts_.size(); ++k) {
    const auto first = static_cast<Eigen::Index>(k) * nodes.size();
    pieces_.emplace_back(values.middleCols(first, nodes.size()) * to_powers);
  }
}

void BorderPieces::evaluate(double parameter, Eigen::Ref<Eigen::VectorXd> jet) const {
  const auto after = std::ranges::upper_bound(starts_, parameter);
  const auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, after - starts_.begin()) - 1);
  const double end = k + 1 < starts_.size() ? starts_[k + 1] : 1.0;
  const double place = (parameter - starts_[k]) / (end - starts_[k]);
  const Eigen::MatrixXd& piece = pieces_[k];
  jet = piece.rightCols<1>();
  for (Eigen::Index m = piece.cols() - 2; m >= 0; --m) jet = place * jet + piece.col(m);
}

}  // namespace crease

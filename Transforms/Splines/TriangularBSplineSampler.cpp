#include "Transforms/Splines/TriangularBSplineSampler.h"

#include <algorithm>
#include <optional>

#include "Core/Parallel.h"
#include "Transforms/Splines/Continuation.h"
#include "Transforms/Splines/TriangularBSplineEvaluator.h"

namespace crease {
namespace {

constexpr int kLanes = LanePoints::kMaxLanes;
constexpr double kReach =
    0.25;  // of a triangle's size: points farther apart are not evaluated together

}  // namespace

/// Points of strips that wait until they fill the lanes.
class TriangularBSplineSampler::StripPoints {
 public:
  StripPoints(const TriangularBSplineSampler& sampler, Eigen::Ref<Eigen::MatrixXd>& jets)
      : sampler_(sampler), jets_(jets) {}

  void add(const Point<2>& x, int triangle, std::size_t column) {
    const auto& patch = sampler_.basis_.patch(triangle);
    const auto away = [&] {
      const double reach = kReach * patch.size();
      return std::abs(x.x() - lanes_.x[0]) > reach || std::abs(x.y() - lanes_.y[0]) > reach;
    };
    if (count_ == kLanes || (count_ > 0 && away())) finish();
    lanes_.x[count_] = lanes_.side_x[count_] = x.x();
    lanes_.y[count_] = lanes_.side_y[count_] = x.y();
    lanes_.inside_x[count_] = patch.centre().x();
    lanes_.inside_y[count_] = patch.centre().y();
    columns_[count_++] = static_cast<Eigen::Index>(column);
    if (std::ranges::find(holders_, triangle) == holders_.end()) holders_.push_back(triangle);
  }

  /// Evaluates those that wait.
  void finish() {
    if (count_ == 0) return;
    thread_local TriangularBSplineEvaluator::Scratch scratch;
    fill_lanes(lanes_, count_);
    sampler_.evaluator_.evaluate(lanes_, holders_, 1, scratch);
    const Eigen::MatrixXd& phi = sampler_.phi_;
    const Eigen::Index rows = phi.rows();
    double sums[3][3][kLanes] = {};  // derivative, coordinate
    const auto found = scratch.control_points();
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (int d = 0; d < 3; ++d) {
        const double* values = scratch.lanes(static_cast<int>(i), d);
        for (Eigen::Index a = 0; a < rows; ++a) {
          const double weight = phi(a, found[i]);
          for (int l = 0; l < lanes_.lanes; ++l) sums[d][a][l] += weight * values[l];
        }
      }
    }
    for (int l = 0; l < count_; ++l) {
      for (int d = 0; d < 3; ++d) {
        for (Eigen::Index a = 0; a < rows; ++a) jets_(d * rows + a, columns_[l]) = sums[d][a][l];
      }
    }
    count_ = 0;
    holders_.clear();
  }

 private:
  const TriangularBSplineSampler& sampler_;
  Eigen::Ref<Eigen::MatrixXd>& jets_;
  LanePoints lanes_;
  int count_ = 0;
  Eigen::Index columns_[kLanes] = {};
  std::vector<int> holders_;
};

TriangularBSplineSampler::TriangularBSplineSampler(
    const TriangularBSplineBasis<2>& basis, const TriangularBSplineEvaluator& evaluator,
    const NearestFacets<2>& border, const Eigen::Ref<const Eigen::MatrixXd>& control_points)
    : basis_(basis), evaluator_(evaluator), border_(border), phi_(control_points) {
  const int count = static_cast<int>(basis.net().mesh.simplices.size());
  for (int t = 0; t < count; ++t) {
    const auto points = basis.control_points_of(t);
    Eigen::MatrixXd own(phi_.rows(), static_cast<Eigen::Index>(points.size()));
    for (Eigen::Index b = 0; b < own.cols(); ++b) own.col(b) = phi_.col(points[b]);
    cores_.emplace_back(own * basis.patch(t).matrix().transpose());
  }
  std::vector<std::optional<BorderPieces>> built(static_cast<std::size_t>(border.num_facets()));
  parallel_for(border.num_facets(), [&](std::int64_t edge) {
    built[static_cast<std::size_t>(edge)] = pieces_along(static_cast<int>(edge));
  });
  for (auto& pieces : built) pieces_.push_back(std::move(*pieces));
}

BorderPieces TriangularBSplineSampler::pieces_along(int edge) const {
  const Point<2>&a = border_.corners(edge)[0], &b = border_.corners(edge)[1];
  const int triangle = basis_.find_simplex(0.5 * (a + b));
  const auto evaluate = [&](const std::vector<double>& parameters) {
    Eigen::MatrixXd jets(3 * phi_.rows(), static_cast<Eigen::Index>(parameters.size()));
    Eigen::Ref<Eigen::MatrixXd> all = jets;
    StripPoints points(*this, all);
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      points.add(a + parameters[k] * (b - a), triangle, k);
    }
    points.finish();
    return jets;
  };
  return {evaluator_.breaks_along(triangle, a, b), basis_.degree(), evaluate};
}

void TriangularBSplineSampler::sample_core(int triangle, const Point<2>& x, Jet jet) const {
  const auto& patch = basis_.patch(triangle);
  const double slope = 1 / patch.size();
  const Vector<2> local = slope * (x - patch.centre());
  double X[kMaxSplineDegree + 2], Y[kMaxSplineDegree + 2];  // powers, from the power -1 on
  X[0] = Y[0] = 0;
  X[1] = Y[1] = 1;
  for (int k = 1; k <= basis_.degree(); ++k) {
    X[k + 1] = X[k] * local.x();
    Y[k + 1] = Y[k] * local.y();
  }
  const Eigen::MatrixXd& coefficients = cores_[triangle];
  const Eigen::Index rows = coefficients.rows();
  jet.setZero();
  for (Eigen::Index m = 0; m < coefficients.cols(); ++m) {
    const auto [i, j] = kMonomials<2>[m];
    const double value = X[i + 1] * Y[j + 1], by_x = slope * i * X[i] * Y[j + 1],
                 by_y = slope * j * X[i + 1] * Y[j];
    for (Eigen::Index a = 0; a < rows; ++a) {
      const double c = coefficients(a, m);
      jet[a] += c * value;
      jet[rows + a] += c * by_x;
      jet[2 * rows + a] += c * by_y;
    }
  }
}

void TriangularBSplineSampler::sample_outside(const Point<2>& x, Jet jet) const {
  const auto [edge, p] = border_.find(x);
  const auto& [a, b] = border_.corners(edge);
  const Vector<2> along = b - a, away = x - p;
  pieces_[edge].evaluate(std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0), jet);
  const Continuation<2> on(away, basis_.mean_edge_length());
  const Eigen::Index rows = phi_.rows();
  auto gradient = jet.tail(2 * rows).reshaped(rows, 2);
  jet.head(rows) += gradient * on.step;
  gradient = (gradient * on.stretch).eval();
}

void TriangularBSplineSampler::sample(std::span<const Point<2>> x, Eigen::Ref<Eigen::MatrixXd> jets,
                                      std::span<std::uint8_t> inside) const {
  StripPoints strips(*this, jets);
  int last = -1;  // core that held a point
  for (std::size_t k = 0; k < x.size(); ++k) {
    const bool again = last >= 0 && basis_.in_core(last, x[k]);
    const int triangle = again ? last : basis_.find_simplex(x[k]);
    inside[k] = triangle >= 0 ? 1 : 0;
    auto jet = jets.col(static_cast<Eigen::Index>(k));
    if (triangle < 0) {
      sample_outside(x[k], jet);
    } else if (again || basis_.in_core(triangle, x[k])) {
      last = triangle;
      sample_core(triangle, x[k], jet);
    } else {
      strips.add(x[k], triangle, k);
    }
  }
  strips.finish();
}

}  // namespace crease

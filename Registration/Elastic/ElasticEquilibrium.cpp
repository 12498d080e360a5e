#include "Registration/Elastic/ElasticEquilibrium.h"

#include <algorithm>
#include <cmath>

#include "Registration/Elastic/PairText.h"

namespace crease {
namespace {

constexpr double kForceFloor = 1e-13;  // times stiffness and size of the body
/// Powers of ten: shares of its diagonal by which an indefinite tangent is shifted; the last one is beyond any
/// need of a matrix that is finite.
constexpr int kFirstPower = -4, kLastPower = 12;

/// Tight enough for Newton's method to go on converging fast.
constexpr LinearSolverOptions kConjugateGradients = {
    .kind = LinearSolver::kPreconditionedCg, .cg_tolerance = 1e-4, .max_cg_iterations = 30};

DampedSolver make_solver(LinearSolver kind, Eigen::Index columns) {
  if (kind == LinearSolver::kDirect) return {{.kind = kind}, columns};
  LinearSolverOptions options = kConjugateGradients;
  options.kind = kind;
  return {options, columns};
}

}  // namespace

ElasticEquilibrium::ElasticEquilibrium(const ElasticEnergy<2>& energy, const NullSpace& null_space,
                                       const LoadStepOptions& options)
    : energy_(energy),
      null_space_(null_space),
      options_(options),
      force_floor_(kForceFloor * energy.largest_stiffness() * std::sqrt(energy.measure())),
      solver_(make_solver(options.solver, null_space.num_columns())),
      hessian_(energy.pattern()) {
  const auto& rows = null_space.independent_rows();
  const auto& C = null_space.constraints().C;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(C, rows[r]); it; ++it) {
      entries.emplace_back(static_cast<int>(r), static_cast<int>(it.col()), it.value());
    }
  }
  independent_.resize(std::ssize(rows), C.cols());
  independent_.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double, Eigen::RowMajor> transposed = independent_.transpose();
  gram_.compute(Eigen::MatrixXd(independent_ * transposed));
  state_ = evaluate(ControlPoints<2>::Zero(2, energy.pattern()->size()));
}

ElasticEquilibrium::State ElasticEquilibrium::evaluate(ControlPoints<2> phi) const {
  State state;
  ControlPoints<2> force = ControlPoints<2>::Zero(2, phi.cols());
  state.energy = energy_.evaluate(phi, 1, &force, nullptr, ElasticTangent::kExact, &state.least);
  state.phi = std::move(phi);
  state.force = force.reshaped();
  state.reduced = null_space_.apply_transpose(state.force);
  const Eigen::Map<const RowMatrix> rows(state.force.data(), null_space_.num_rows(),
                                         null_space_.num_columns());
  const RowMatrix found = gram_.solve(Eigen::MatrixXd(independent_ * rows));
  state.reactions = RowMatrix::Zero(null_space_.constraints().num_rows(), rows.cols());
  for (Eigen::Index r = 0; r < found.rows(); ++r) {
    state.reactions.row(null_space_.independent_rows()[r]) = found.row(r);
  }
  state.residual = state.reduced.norm() / std::max(found.norm(), force_floor_);
  return state;
}

void ElasticEquilibrium::assemble() {
  hessian_.set_zero();
  energy_.evaluate(state_.phi, 1, nullptr, &hessian_, ElasticTangent::kExact, nullptr);
  hessian_.to_sparse(tangent_);
  null_space_.reduce_hessian(tangent_, solver_.hessian());
  solver_.hessian_changed();
}

/// Shifts an indefinite tangent until it is positive definite.
std::optional<Eigen::VectorXd> ElasticEquilibrium::solve(const Eigen::VectorXd& rhs,
                                                         bool& indefinite) {
  auto y = solver_.solve(rhs, 0);
  indefinite = !y;
  for (int power = kFirstPower; !y && power <= kLastPower; ++power) {
    y = solver_.solve(rhs, std::pow(10.0, power));
  }
  return y;
}

bool ElasticEquilibrium::stable() {
  assemble();
  const Eigen::SparseMatrix<double>& tangent = solver_.hessian();
  if (tangent.cols() == 0) return true;
  ++further_factorizations_;
  return SparseCholesky().factor(tangent);
}

std::optional<std::string> ElasticEquilibrium::predict(double share, bool& indefinite) {
  const RowMatrix& offset = null_space_.offset();
  const Eigen::VectorXd start =
      share * Eigen::Map<const Eigen::VectorXd>(offset.data(), offset.size());
  assemble();
  Eigen::VectorXd force = tangent_.selfadjointView<Eigen::Lower>() * start;
  if (options_.corrector == LoadCorrector::kNewton) force += state_.force;
  const auto y = solve(-null_space_.apply_transpose(force), indefinite);
  if (!y) return "the tangent is singular";
  const Eigen::VectorXd step = start + null_space_.apply(*y);
  state_ = evaluate(state_.phi + step.reshaped(2, state_.phi.cols()));
  if (!std::isfinite(state_.energy)) {
    return "the map folds near " + place_text(state_.least.place);
  }
  return std::nullopt;
}

/// Halves the step along a direction until W falls.
bool ElasticEquilibrium::search(const Eigen::VectorXd& step) {
  constexpr int kMostHalvings = 10;
  constexpr double kDecrease = 1e-4, kRounding = 1e-12;
  const double slope = state_.force.dot(step);
  double length = 1;
  for (int halving = 0; halving <= kMostHalvings; ++halving, length /= 2) {
    State trial = evaluate(state_.phi + length * step.reshaped(2, state_.phi.cols()));
    const double allowed =
        state_.energy + kDecrease * length * slope + kRounding * std::abs(state_.energy);
    if (!(trial.energy <= allowed)) continue;
    state_ = std::move(trial);
    return true;
  }
  return false;
}

std::optional<std::string> ElasticEquilibrium::correct(const SplineBasis<2>& basis,
                                                       LoadStepRecord& record) {
  // Iterations in a row: St. Venant-Kirchhoff tissue that stays inside out so long comes to rest so.
  constexpr int kMostFolded = 6;
  record.residuals.push_back(state_.residual);
  int folded = 0;
  while (state_.residual > options_.tolerance) {
    folded = state_.least.value > 0 ? 0 : folded + 1;
    if (folded > kMostFolded) return fold_text();
    if (record.newton_iterations == options_.max_iterations) {
      return message("Newton's method did not converge in ", options_.max_iterations,
                     " iterations; forces are least balanced near ", worst_place(basis));
    }
    assemble();
    const auto y = solve(-state_.reduced, record.indefinite_tangent);
    if (!y || !search(null_space_.apply(*y))) {
      return message("no step lowers the stored energy; forces are least balanced near ",
                     worst_place(basis));
    }
    ++record.newton_iterations;
    record.residuals.push_back(state_.residual);
  }
  return std::nullopt;
}

std::optional<std::string> ElasticEquilibrium::advance(double share, const SplineBasis<2>& basis,
                                                       LoadStepRecord& record) {
  const State before = state_;
  const int factorizations = num_factorizations();
  record = {};
  auto failure = predict(share, record.indefinite_tangent);
  if (!failure && options_.corrector == LoadCorrector::kNewton) failure = correct(basis, record);
  if (!failure && !(state_.least.value > 0)) failure = fold_text();
  record.factorizations = num_factorizations() - factorizations;
  if (failure) {
    state_ = before;
    return failure;
  }
  if (options_.corrector == LoadCorrector::kNone) record.residuals.push_back(state_.residual);
  record.least_determinant = state_.least.value;
  if (state_.reactions.rows() > 0) {
    record.largest_reaction =
        state_.reactions.rowwise().norm().maxCoeff(&record.largest_reaction_row);
  }
  return std::nullopt;
}

std::string ElasticEquilibrium::fold_text() const {
  return message("the map folds (det F = ", state_.least.value, ") at ",
                 place_text(state_.least.place));
}

/// Where the force that no constraint balances is largest.
std::string ElasticEquilibrium::worst_place(const SplineBasis<2>& basis) const {
  RowMatrix found(independent_.rows(), state_.reactions.cols());
  for (Eigen::Index r = 0; r < found.rows(); ++r) {
    found.row(r) = state_.reactions.row(null_space_.independent_rows()[r]);
  }
  const RowMatrix held = independent_.transpose() * found;
  const Eigen::VectorXd unbalanced =
      state_.force - Eigen::Map<const Eigen::VectorXd>(held.data(), held.size());
  Eigen::Index worst = 0;
  unbalanced.reshaped(2, state_.phi.cols()).colwise().norm().maxCoeff(&worst);
  return place_text(basis.greville_points().col(worst));
}

}  // namespace crease

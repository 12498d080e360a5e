#include "Optimizers/SparseCholesky.h"

#include <cholmod.h>

#include <algorithm>
#include <vector>

#include "Core/Error.h"
#include "Optimizers/LibraryThreads.h"

namespace crease {

struct SparseCholesky::State {
  State();
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  bool knows(const Eigen::SparseMatrix<double>& A) const;
  void analyse(const Eigen::SparseMatrix<double>& A, cholmod_sparse* view);

  mutable cholmod_common common{};
  cholmod_factor* L = nullptr;
  bool factored = false;
  Eigen::Index size = 0;
  std::vector<int> outer, inner;  // the analysed pattern
  // Kept from solve to solve, so that these do not allocate.
  mutable cholmod_dense* X = nullptr;
  mutable cholmod_dense* Y = nullptr;
  mutable cholmod_dense* E = nullptr;
};

namespace {

cholmod_sparse view_of(const Eigen::SparseMatrix<double>& A) {
  cholmod_sparse view{};
  view.nrow = static_cast<std::size_t>(A.rows());
  view.ncol = static_cast<std::size_t>(A.cols());
  view.nzmax = static_cast<std::size_t>(A.nonZeros());
  view.p = const_cast<int*>(A.outerIndexPtr());
  view.i = const_cast<int*>(A.innerIndexPtr());
  view.x = const_cast<double*>(A.valuePtr());
  view.stype = -1;  // lower triangle
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

void check_memory(const cholmod_common& common) {
  if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE) {
    throw SolverError("sparse Cholesky factorisation: out of memory; use fewer control points.");
  }
}

}  // namespace

SparseCholesky::State::State() {
  cholmod_start(&common);
  common.print = 0;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_AMD;
  common.postorder = 1;
  common.final_ll = 1;  // L L^T also when simplicial: it notices matrices that are not definite
}

SparseCholesky::State::~State() {
  cholmod_free_factor(&L, &common);
  cholmod_free_dense(&X, &common);
  cholmod_free_dense(&Y, &common);
  cholmod_free_dense(&E, &common);
  cholmod_finish(&common);
}

bool SparseCholesky::State::knows(const Eigen::SparseMatrix<double>& A) const {
  return L != nullptr && size == A.rows() &&
         std::equal(outer.begin(), outer.end(), A.outerIndexPtr(),
                    A.outerIndexPtr() + A.outerSize() + 1) &&
         std::equal(inner.begin(), inner.end(), A.innerIndexPtr(),
                    A.innerIndexPtr() + A.nonZeros());
}

void SparseCholesky::State::analyse(const Eigen::SparseMatrix<double>& A, cholmod_sparse* view) {
  cholmod_free_factor(&L, &common);
  L = cholmod_analyze(view, &common);
  check_memory(common);
  if (L == nullptr) {
    throw SolverError(message("sparse Cholesky: the analysis of a ", A.rows(), " x ", A.cols(),
                              " matrix failed (CHOLMOD status ", common.status, ")."));
  }
  size = A.rows();
  outer.assign(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1);
  inner.assign(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
}

SparseCholesky::SparseCholesky() : state_(std::make_unique<State>()) {}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

bool SparseCholesky::factor(const Eigen::SparseMatrix<double>& A) {
  if (A.rows() != A.cols() || !A.isCompressed()) {
    throw InvalidInput(message("sparse Cholesky: expected a square compressed matrix, got ",
                               A.rows(), " x ", A.cols(),
                               A.isCompressed() ? "" : ", not compressed", "."));
  }
  const SingleThreadedLibraries single;
  State& state = *state_;
  cholmod_sparse view = view_of(A);
  if (!state.knows(A)) state.analyse(A, &view);
  cholmod_factorize(&view, state.L, &state.common);
  check_memory(state.common);
  state.factored = state.common.status == CHOLMOD_OK && state.L->minor == state.L->n &&
                   cholmod_rcond(state.L, &state.common) > 0.0;
  return state.factored;
}

bool SparseCholesky::has_factor() const { return state_->factored; }
Eigen::Index SparseCholesky::size() const { return state_->size; }

// CHOLMOD's systems, one after the other.
Eigen::MatrixXd SparseCholesky::solve_systems(std::initializer_list<int> systems,
                                              const Eigen::Ref<const Eigen::MatrixXd>& B) const {
  const State& state = *state_;
  if (!state.factored || B.rows() != state.size) {
    throw InvalidInput(message("sparse Cholesky: ", state.factored ? "" : "no factor; ",
                               "right-hand side of ", B.rows(), " rows for a matrix of size ",
                               state.size, "."));
  }
  const SingleThreadedLibraries single;
  Eigen::MatrixXd solution = B;
  for (const int system : systems) {
    cholmod_dense rhs{};
    rhs.nrow = static_cast<std::size_t>(solution.rows());
    rhs.ncol = static_cast<std::size_t>(solution.cols());
    rhs.d = rhs.nrow;
    rhs.nzmax = rhs.d * rhs.ncol;
    rhs.x = solution.data();
    rhs.xtype = CHOLMOD_REAL;
    rhs.dtype = CHOLMOD_DOUBLE;
    cholmod_solve2(system, state.L, &rhs, nullptr, &state.X, nullptr, &state.Y, &state.E,
                   &state.common);
    check_memory(state.common);
    solution = Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(state.X->x),
                                                 solution.rows(), solution.cols());
  }
  return solution;
}

Eigen::MatrixXd SparseCholesky::solve_columns(const Eigen::Ref<const Eigen::MatrixXd>& B) const {
  return solve_systems({CHOLMOD_A}, B);
}

Eigen::MatrixXd SparseCholesky::solve_root(const Eigen::Ref<const Eigen::MatrixXd>& B) const {
  return solve_systems({CHOLMOD_Lt, CHOLMOD_Pt}, B);
}

Eigen::MatrixXd SparseCholesky::solve_root_transpose(
    const Eigen::Ref<const Eigen::MatrixXd>& B) const {
  return solve_systems({CHOLMOD_P, CHOLMOD_L}, B);
}

Eigen::VectorXd SparseCholesky::solve(const Eigen::Ref<const Eigen::VectorXd>& b) const {
  return solve_columns(b);
}

bool SparseCholesky::is_supernodal() const {
  return state_->L != nullptr && state_->L->is_super != 0;
}

std::size_t SparseCholesky::num_nonzeros() const {
  const cholmod_factor* L = state_->L;
  if (L == nullptr) return 0;
  if (L->is_super != 0) return L->xsize;
  const auto* count = static_cast<const int*>(L->ColCount);
  std::size_t sum = 0;
  for (std::size_t j = 0; j < L->n; ++j) sum += static_cast<std::size_t>(count[j]);
  return sum;
}

}  // namespace crease

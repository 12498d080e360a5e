// The linear algebra of one Gauss-Newton step for 37 x 37 control points and two components, with the
// pattern of a cubic tensor B-spline (7 x 7 neighbours), and whole Gauss-Newton runs of an SSD-like
// function on it, in CPU time without the function's own passes.

#include <benchmark/benchmark.h>

#include <cmath>
#include <ctime>

#include "Optimizers/EliminationNullSpace.h"
#include "Optimizers/GaussNewton.h"
#include "Testing/Benchmarks/Counters.h"
#include "Testing/Optimizers/Problems.h"

namespace crease::benchmarks {
namespace {

constexpr int kSide = 37;
constexpr int kPoints = kSide * kSide;

// Of this thread: other programs on the machine do not count.
double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

const Eigen::SparseMatrix<double>& hessian(int components) {
  static const Eigen::SparseMatrix<double> one = testing::grid_hessian(kSide, 1, 3, 1);
  static const Eigen::SparseMatrix<double> two = testing::grid_hessian(kSide, 2, 3, 1);
  return components == 1 ? one : two;
}

void BM_AnalyseAndFactor(benchmark::State& state) {
  const auto& H = hessian(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    SparseCholesky cholesky;
    benchmark::DoNotOptimize(cholesky.factor(H));
  }
}
BENCHMARK(BM_AnalyseAndFactor)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

void BM_Factor(benchmark::State& state) {
  const auto& H = hessian(static_cast<int>(state.range(0)));
  SparseCholesky cholesky;
  cholesky.factor(H);
  for (auto _ : state) benchmark::DoNotOptimize(cholesky.factor(H));
  state.counters["nnz(H)"] = static_cast<double>(H.nonZeros());
  state.counters["nnz(L)"] = static_cast<double>(cholesky.num_nonzeros());
  count_time(state, "per_nonzero", cholesky.num_nonzeros());
  state.counters["supernodal"] = cholesky.is_supernodal() ? 1 : 0;
}
BENCHMARK(BM_Factor)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

void BM_Solve(benchmark::State& state) {
  const auto& H = hessian(static_cast<int>(state.range(0)));
  SparseCholesky cholesky;
  cholesky.factor(H);
  const Eigen::MatrixXd B = Eigen::MatrixXd::Ones(H.cols(), 2 / state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(cholesky.solve_columns(B));
}
BENCHMARK(BM_Solve)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

void BM_Elimination(benchmark::State& state) {
  const auto constraints =
      testing::landmark_constraints(kSide, static_cast<int>(state.range(0)), 2, 1);
  for (auto _ : state) benchmark::DoNotOptimize(EliminationNullSpace(constraints, kPoints).rank());
}
BENCHMARK(BM_Elimination)->Arg(0)->Arg(12)->Arg(100)->Arg(400)->Unit(benchmark::kMillisecond);

void BM_FirstReduction(benchmark::State& state) {
  const auto constraints =
      testing::landmark_constraints(kSide, static_cast<int>(state.range(0)), 2, 1);
  for (auto _ : state) {
    state.PauseTiming();
    const EliminationNullSpace space(constraints, kPoints);
    Eigen::SparseMatrix<double> reduced;
    state.ResumeTiming();
    space.reduce_hessian(hessian(2), reduced);
    benchmark::DoNotOptimize(reduced.valuePtr());
  }
}
BENCHMARK(BM_FirstReduction)->Arg(0)->Arg(12)->Arg(100)->Unit(benchmark::kMillisecond);

void BM_Reduction(benchmark::State& state) {
  const auto kind = static_cast<NullSpaceKind>(state.range(1));
  const auto space = make_null_space(
      kind, testing::landmark_constraints(kSide, static_cast<int>(state.range(0)), 2, 1), kPoints);
  Eigen::SparseMatrix<double> reduced;
  space->reduce_hessian(hessian(2), reduced);
  for (auto _ : state) {
    space->reduce_hessian(hessian(2), reduced);
    benchmark::DoNotOptimize(reduced.valuePtr());
  }
  state.counters["nnz"] = static_cast<double>(reduced.nonZeros());
}
BENCHMARK(BM_Reduction)
    ->ArgNames({"landmarks", "kind"})
    ->Args({0, 0})
    ->Args({12, 0})
    ->Args({100, 0})
    ->Args({12, 1})
    ->Args({12, 2})
    ->Unit(benchmark::kMillisecond);

// 1/2 sum over samples of (I(x + u(x)) - I(x + u*(x)))^2 + gamma/2 |second differences of u|^2 +
// beta/2 sum over a quarter of the samples of |Green's strain|^2, with u a uniform cubic B-spline.
class SyntheticRegistration final : public ObjectiveFunction {
 public:
  explicit SyntheticRegistration(double beta);
  Eigen::Index size() const override { return 2 * kPoints; }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override;
  double seconds = 0.0;  // spent in passes

 private:
  static constexpr int kPerCell = 6;  // samples along an edge
  static double image(double x, double y, double* gx, double* gy);
  double add_cell(int cx, int cy, const Eigen::Ref<const Eigen::VectorXd>& u,
                  Eigen::VectorXd& gradient);
  double beta_;
  Eigen::SparseMatrix<double> bending_, pattern_;
  Eigen::MatrixXd blocks_;  // 32 x 32 of the current cell
};

double SyntheticRegistration::image(double x, double y, double* gx, double* gy) {
  double value = 0.0;
  *gx = *gy = 0.0;
  for (int n = 1; n <= 6; ++n) {
    const double kx = 0.35 * n * std::cos(2.4 * n);
    const double ky = 0.35 * n * std::sin(2.4 * n);
    value += std::sin(kx * x + ky * y + n) / n;
    *gx += kx * std::cos(kx * x + ky * y + n) / n;
    *gy += ky * std::cos(kx * x + ky * y + n) / n;
  }
  return value;
}

SyntheticRegistration::SyntheticRegistration(double beta) : beta_(beta) {
  std::vector<Eigen::Triplet<double>> differences;
  int row = 0;
  for (int p = 0; p < kPoints; ++p) {
    for (int step : {1, kSide}) {
      const int along = step == 1 ? p % kSide : p / kSide;
      if (along == 0 || along == kSide - 1) continue;
      for (int a = 0; a < 2; ++a) {
        differences.emplace_back(row, 2 * (p - step) + a, 1.0);
        differences.emplace_back(row, 2 * p + a, -2.0);
        differences.emplace_back(row++, 2 * (p + step) + a, 1.0);
      }
    }
  }
  Eigen::SparseMatrix<double> D(row, 2 * kPoints);
  D.setFromTriplets(differences.begin(), differences.end());
  bending_ = 0.05 * (D.transpose() * D);
  pattern_ = testing::grid_hessian(kSide, 2, 3, 1);
  std::fill(pattern_.valuePtr(), pattern_.valuePtr() + pattern_.nonZeros(), 0.0);
  for (int j = 0; j < bending_.cols(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(bending_, j); entry; ++entry) {
      if (entry.row() >= j) pattern_.coeffRef(entry.row(), j) += entry.value();
    }
  }
}

double SyntheticRegistration::evaluate(const Eigen::Ref<const Eigen::VectorXd>& x,
                                       Eigen::VectorXd* gradient,
                                       Eigen::SparseMatrix<double>* hessian) {
  const double start = cpu_seconds();
  *hessian = pattern_;
  *gradient = bending_ * x;
  double value = 0.5 * x.dot(*gradient);
  for (int cy = 0; cy < kSide - 3; ++cy) {
    for (int cx = 0; cx < kSide - 3; ++cx) {
      blocks_ = Eigen::MatrixXd::Zero(32, 32);
      value += add_cell(cx, cy, x, *gradient);
      for (int q = 0; q < 32; ++q) {
        const int column = 2 * ((cy + q / 8) * kSide + cx + q / 2 % 4) + q % 2;
        for (int p = q; p < 32; ++p) {
          const int row = 2 * ((cy + p / 8) * kSide + cx + p / 2 % 4) + p % 2;
          hessian->coeffRef(row, column) += blocks_(p, q);
        }
      }
    }
  }
  seconds += cpu_seconds() - start;
  return value;
}

double SyntheticRegistration::add_cell(int cx, int cy, const Eigen::Ref<const Eigen::VectorXd>& u,
                                       Eigen::VectorXd& gradient) {
  const auto basis = [](double t) {
    return Eigen::Vector4d((1 - t) * (1 - t) * (1 - t) / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                           (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6);
  };
  const auto slope = [](double t) {
    return Eigen::Vector4d(-(1 - t) * (1 - t) / 2, (3 * t * t - 4 * t) / 2,
                           (-3 * t * t + 2 * t + 1) / 2, t * t / 2);
  };
  const bool rigid = cx > kSide / 4 && cx < kSide / 2 && cy > kSide / 4 && cy < 3 * kSide / 4;
  const double area = 1.0 / (kPerCell * kPerCell);
  Eigen::VectorXd local(32);
  Eigen::VectorXd local_gradient = Eigen::VectorXd::Zero(32);
  for (int j = 0; j < 4; ++j) {
    local.segment<8>(8 * j) = u.segment<8>(2 * ((cy + j) * kSide + cx));
  }
  const Eigen::Map<const Eigen::Matrix<double, 2, 16>> phi(local.data());
  double value = 0.0;
  for (int s = 0; s < kPerCell * kPerCell; ++s) {
    const int i_point = s % kPerCell, j_point = s / kPerCell;
    const double tx = (i_point + 0.5) / kPerCell, ty = (j_point + 0.5) / kPerCell;
    Eigen::Matrix<double, 16, 1> B, Bx, By;
    for (int j = 0; j < 4; ++j) {
      B.segment<4>(4 * j) = basis(tx) * basis(ty)[j];
      Bx.segment<4>(4 * j) = slope(tx) * basis(ty)[j];
      By.segment<4>(4 * j) = basis(tx) * slope(ty)[j];
    }
    const double x = cx + tx;
    const double y = cy + ty;
    double gx, gy, unused;
    const Eigen::Vector2d shift = phi * B;
    const double fixed =
        image(x + 0.8 * std::sin(0.2 * y), y + 0.8 * std::cos(0.25 * x), &unused, &unused);
    const double r = image(x + shift[0], y + shift[1], &gx, &gy) - fixed;
    Eigen::VectorXd row(32);
    for (int i = 0; i < 16; ++i) row.segment<2>(2 * i) = Eigen::Vector2d(gx, gy) * B[i];
    value += 0.5 * area * r * r;
    local_gradient += area * r * row;
    blocks_.selfadjointView<Eigen::Lower>().rankUpdate(row, area);
    if (!rigid || beta_ == 0.0) continue;
    Eigen::Matrix2d F;
    F << phi * Bx, phi * By;
    F += Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d E = 0.5 * (F.transpose() * F - Eigen::Matrix2d::Identity());
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) {
        const auto& Ba = a == 0 ? Bx : By;
        const auto& Bb = b == 0 ? Bx : By;
        for (int i = 0; i < 16; ++i)
          row.segment<2>(2 * i) = 0.5 * (F.col(b) * Ba[i] + F.col(a) * Bb[i]);
        value += 0.5 * beta_ * area * E(a, b) * E(a, b);
        local_gradient += beta_ * area * E(a, b) * row;
        blocks_.selfadjointView<Eigen::Lower>().rankUpdate(row, beta_ * area);
      }
    }
  }
  for (int j = 0; j < 4; ++j) {
    gradient.segment<8>(2 * ((cy + j) * kSide + cx)) += local_gradient.segment<8>(8 * j);
  }
  return value;
}

void BM_GaussNewton(benchmark::State& state) {
  SyntheticRegistration function(static_cast<double>(state.range(1)));
  const auto space = make_null_space(
      NullSpaceKind::kElimination,
      [&] {
        auto constraints =
            testing::landmark_constraints(kSide, static_cast<int>(state.range(2)), 2, 1);
        constraints.d *= 0.1;
        return constraints;
      }(),
      kPoints);
  const GaussNewton optimizer(
      {.relative_decrease = 1e-3, .small_decreases = 1},
      {.linear_solver = {.kind = static_cast<LinearSolver>(state.range(0))}});
  OptimizerResult result;
  for (auto _ : state) {
    function.seconds = 0.0;
    const double start = cpu_seconds();
    result = optimizer.minimize(function, Eigen::VectorXd::Zero(function.size()), space.get());
    state.SetIterationTime(cpu_seconds() - start - function.seconds);
  }
  int cg = 0;
  for (const auto& record : result.history) cg += record.linear_iterations;
  state.counters["iterations"] = result.iterations;
  state.counters["evaluations"] = result.num_evaluations;
  state.counters["factorizations"] = result.num_factorizations;
  state.counters["cg"] = cg;
  state.counters["E"] = result.value;
}
BENCHMARK(BM_GaussNewton)
    ->ArgNames({"solver", "beta", "landmarks"})
    ->ArgsProduct({{0, 1, 2}, {0, 100}, {0, 12}})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace
}  // namespace crease::benchmarks

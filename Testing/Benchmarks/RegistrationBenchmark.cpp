// The registration of the spine phantom, creases along five vertebrae and twenty exact landmarks, as `crease
// register` composes it: its parts, one iteration, and the whole in process. 512 x 512 pixels, or the same
// scene on 2294 x 1914.
#include <benchmark/benchmark.h>

#include <map>
#include <memory>

#include "Images/Resample.h"
#include "Optimizers/GaussNewton.h"
#include "Registration/CreasedDomain.h"
#include "Registration/ImageLevels.h"
#include "Registration/Phantoms/Phantom.h"
#include "Testing/Benchmarks/Counters.h"

namespace crease::benchmarks {
namespace {

const Phantom& spine() {
  static const Phantom phantom = make_phantom("spine");
  return phantom;
}

CreasedDomain spine_domain() {
  return make_creased_domain(rectangle_of(spine().labels.raster()), spine().labels, {});
}

struct Pair {
  Image<float, 2> fixed, moving;
};

Pair make_pair(const std::array<int, 2>& size) {
  const Raster<2>& own = spine().fixed.raster();
  if (size == own.size) return {spine().fixed, spine().moving};
  Raster<2> raster = own;
  raster.size = size;
  for (int a = 0; a < 2; ++a) raster.spacing[a] = own.size[a] * own.spacing[a] / size[a];
  raster.origin += own.point({-0.5, -0.5}) - raster.point({-0.5, -0.5});
  const PointMap<2> stay = [](const Point<2>& x) { return x; };
  return {resample(*make_interpolator(spine().fixed), raster, stay),
          resample(*make_interpolator(spine().moving), raster, stay)};
}

/// Made once per size. Arguments: width, height, threads.
const Pair& images_of(const benchmark::State& state) {
  static std::map<std::int64_t, Pair> pairs;
  const std::array<int, 2> size = {static_cast<int>(state.range(0)),
                                   static_cast<int>(state.range(1))};
  if (!pairs.contains(size[0])) pairs[size[0]] = make_pair(size);
  return pairs[size[0]];
}

std::int64_t num_pixels(const benchmark::State& state) { return state.range(0) * state.range(1); }

/// The finest level of the registration.
struct Problem {
  explicit Problem(const Pair& images) : domain(spine_domain()) {
    const auto& basis = *domain.basis;
    const auto level =
        image_levels<2>(images.fixed, images.moving, nullptr, nullptr, 1, {.smooth_finest = true});
    const std::shared_ptr<Metric<2>> metric =
        ssd<2>()({level[0].fixed, level[0].weights, level[0].moving, level[0].moving_mask});
    pattern = std::make_shared<HessianPattern>(basis.num_control_points(), basis.couplings());
    const auto term =
        std::make_shared<ImageTerm<2>>(basis.bind(images.fixed.raster()), metric, AffineMap<2>());
    const std::vector<WeightedEnergy<2>> energies = {
        {"bending", default_bending_weight(basis), bending<2>(body_weights<2>())(basis, {})},
        {"rigidity", 1, rigidity<2>()(basis, {})}};
    objective = std::make_unique<RegistrationObjective<2>>(pattern, term, 1, energies);
    null_space =
        make_landmark_constraints<2>(spine().landmarks, basis, {}, {}, NullSpaceKind::kElimination)
            .null_space;
    start = null_space->expand(Eigen::VectorXd::Zero(null_space->reduced_size()));
  }
  Eigen::SparseMatrix<double> hessian() const {
    Eigen::VectorXd gradient;
    Eigen::SparseMatrix<double> matrix;
    objective->evaluate(start, &gradient, &matrix);
    return matrix;
  }
  CreasedDomain domain;
  std::shared_ptr<const HessianPattern> pattern;
  std::unique_ptr<RegistrationObjective<2>> objective;
  std::shared_ptr<const NullSpace> null_space;
  Eigen::VectorXd start;
};

/// Made once per size.
Problem& problem_of(std::int64_t width, const Pair& images) {
  static std::map<std::int64_t, std::unique_ptr<Problem>> problems;
  auto& problem = problems[width];
  if (problem == nullptr) problem = std::make_unique<Problem>(images);
  return *problem;
}

void sizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"width", "height", "threads"})->Unit(benchmark::kMillisecond);
  for (const int threads : {1, 2}) b->Args({512, 512, threads})->Args({2294, 1914, threads});
}

void BM_SpineDomain(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(0)));
  spine();
  std::int64_t triangles = 0;
  for (auto _ : state) triangles = std::ssize(spine_domain().mesh.mesh.simplices);
  state.counters["triangles"] = static_cast<double>(triangles);
  count_time(state, "per_triangle", triangles, threads.count());
}
BENCHMARK(BM_SpineDomain)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// Bending of the soft tissue and rigidity of the bodies.
void BM_SpineEnergyAssembly(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(0)));
  const CreasedDomain domain = spine_domain();
  const auto factory =
      state.range(1) == 0 ? bending<2>(body_weights<2>()) : rigidity<2>(body_weights<2>());
  for (auto _ : state) benchmark::DoNotOptimize(factory(*domain.basis, {}));
  count_time(state, "per_triangle", domain.mesh.mesh.simplices.size(), threads.count());
  state.SetLabel(state.range(1) == 0 ? "bending" : "rigidity");
}
BENCHMARK(BM_SpineEnergyAssembly)
    ->ArgNames({"threads", "rigidity"})
    ->ArgsProduct({{1, 2}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// Value, gradient and Gauss-Newton matrix of images and energies together: what an iteration evaluates.
void BM_SpinePass(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(2)));
  const Problem& problem = problem_of(state.range(0), images_of(state));
  Eigen::VectorXd gradient;
  Eigen::SparseMatrix<double> hessian;
  for (auto _ : state) {
    benchmark::DoNotOptimize(problem.objective->evaluate(problem.start, &gradient, &hessian));
  }
  count_time(state, "per_pixel", num_pixels(state), threads.count());
}
BENCHMARK(BM_SpinePass)->Apply(sizes)->UseRealTime();

/// The scalar matrix that serves both coordinates: the mean of their diagonal blocks.
Eigen::SparseMatrix<double> scalar_part(const Eigen::SparseMatrix<double>& hessian) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < hessian.cols(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(hessian, j); entry; ++entry) {
      if ((entry.row() - j) % 2 != 0) continue;
      entries.emplace_back(static_cast<int>(entry.row() / 2), j / 2, 0.5 * entry.value());
    }
  }
  Eigen::SparseMatrix<double> scalar(hessian.rows() / 2, hessian.cols() / 2);
  scalar.setFromTriplets(entries.begin(), entries.end());
  return scalar;
}

/// Reduction to the null space of the landmarks and Cholesky factorisation, the pattern being known.
void BM_SpineFactor(benchmark::State& state) {
  const Threads one_thread;
  const Problem& problem = problem_of(512, make_pair({512, 512}));
  const bool scalar = state.range(0) != 0;
  const Eigen::SparseMatrix<double> full = problem.hessian();
  const Eigen::SparseMatrix<double> matrix = scalar ? scalar_part(full) : full;
  Eigen::SparseMatrix<double> reduced;
  SparseCholesky cholesky;
  const auto factor = [&] {
    if (scalar) {
      problem.null_space->reduce_scalar(matrix, reduced);
    } else {
      problem.null_space->reduce_hessian(matrix, reduced);
    }
    return cholesky.factor(reduced);
  };
  if (!factor()) state.SkipWithError("the matrix is not positive definite");
  for (auto _ : state) benchmark::DoNotOptimize(factor());
  state.counters["unknowns"] = static_cast<double>(reduced.cols());
  state.counters["nnz(L)"] = static_cast<double>(cholesky.num_nonzeros());
  count_time(state, "per_nonzero", cholesky.num_nonzeros());
}
BENCHMARK(BM_SpineFactor)->ArgName("scalar")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// One Gauss-Newton iteration, the mean of the first five: solve, evaluate, accept.
void BM_SpineIteration(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(2)));
  const Problem& problem = problem_of(state.range(0), images_of(state));
  const GaussNewton optimizer(
      {.relative_decrease = 0, .relative_gradient = 0, .max_iterations = 5});
  OptimizerResult result;
  for (auto _ : state) {
    result = optimizer.minimize(*problem.objective, problem.start, problem.null_space.get());
    const double seconds = result.history.back().seconds - result.history.front().seconds;
    state.SetIterationTime(seconds / result.iterations);
  }
  state.counters["evaluations"] = static_cast<double>(result.num_evaluations) / result.iterations;
  count_time(state, "per_pixel", num_pixels(state), threads.count());
}
BENCHMARK(BM_SpineIteration)->Apply(sizes)->UseManualTime();

/// From images, labels and landmarks in memory to the transform.
void BM_SpineRegistration(benchmark::State& state) {
  const Threads threads(static_cast<int>(state.range(2)));
  const Pair& images = images_of(state);
  RegistrationResult<2> result;
  for (auto _ : state) {
    const CreasedDomain domain = spine_domain();
    Registration<2> registration(images.fixed, images.moving);
    registration.basis(domain.basis)
        .energy("bending", default_bending_weight(*domain.basis), bending<2>(body_weights<2>()))
        .energy("rigidity", 1, rigidity<2>())
        .landmarks(spine().landmarks);
    result = registration.run();
  }
  for (const auto& [stage, seconds] : result.timings_s) {
    state.counters[stage + "_s"] = seconds;
  }
  double iterations = 0;
  for (const auto& level : result.levels) iterations += level.iterations;
  state.counters["iterations"] = iterations;
  count_time(state, "per_pixel", num_pixels(state), threads.count());
}
BENCHMARK(BM_SpineRegistration)->Apply(sizes)->UseRealTime();

}  // namespace
}  // namespace crease::benchmarks

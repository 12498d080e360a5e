// The optimizers on the finest level of a registration, 512 x 512 pixels, from where half the resolution leads:
// iterations, passes and time until the cost is within 0.1 % of its fall above the minimum, and what an
// optimizer costs beside the evaluation of the cost.
#include <benchmark/benchmark.h>

#include <ctime>
#include <map>
#include <memory>

#include "Optimizers/GaussNewton.h"
#include "Optimizers/Lbfgs.h"
#include "Optimizers/NonlinearConjugateGradient.h"
#include "Optimizers/SteepestDescent.h"
#include "Registration/CreasedDomain.h"
#include "Registration/ImageLevels.h"
#include "Registration/Phantoms/Phantom.h"
#include "Registration/SamplesInside.h"
#include "Registration/StartingPoint.h"
#include "Testing/Benchmarks/Counters.h"

namespace crease::benchmarks {
namespace {

/// Processor time, which other jobs on the machine do not change.
double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Passes everything on and adds up the time that it takes.
class Timed final : public ObjectiveFunction {
 public:
  explicit Timed(ObjectiveFunction& inner) : inner_(inner) {}
  Eigen::Index size() const override { return inner_.size(); }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    const double start = now();
    const double value = inner_.evaluate(x, gradient, hessian);
    seconds += now() - start;
    return value;
  }
  bool preconditioner(const Eigen::Ref<const Eigen::VectorXd>& x,
                      Eigen::SparseMatrix<double>& matrix) override {
    return inner_.preconditioner(x, matrix);
  }
  double step_length(const Eigen::Ref<const Eigen::VectorXd>& step) const override {
    return inner_.step_length(step);
  }
  double seconds = 0;

 private:
  ObjectiveFunction& inner_;
};

enum Scene { kBlobs, kFineBlobs, kSpine };

MetricFactory<2> metric_of(std::int64_t kind) {
  if (kind == 1) return ncc<2>();
  return kind == 2 ? mutual_information<2>() : ssd<2>();
}

/// The cost on one level of two.
struct Problem {
  Problem(Scene scene, std::int64_t metric) {
    const Phantom phantom = scene == kSpine ? make_phantom("spine")
                                            : make_phantom("blobs", {.size = 512, .noise = 0.01});
    const RegionOfInterest region = rectangle_of(phantom.fixed.raster());
    domain = scene == kSpine
                 ? make_creased_domain(region, phantom.labels, {})
                 : make_creased_domain(region, std::vector<FeatureLine>{},
                                       {.edge_length = scene == kFineBlobs ? 24.0 : 43.0});
    const auto& basis = *domain->basis;
    const std::shared_ptr<const HessianPattern> pattern = basis.pattern();
    null_space =
        make_landmark_constraints<2>(phantom.landmarks, basis, {}, {}, NullSpaceKind::kElimination)
            .null_space;
    std::vector<WeightedEnergy<2>> energies;
    const auto bodies = scene == kSpine ? body_weights<2>() : nullptr;
    energies.push_back({"bending", default_bending_weight(basis), bending<2>(bodies)(basis, {})});
    if (scene == kSpine) energies.push_back({"rigidity", 1, rigidity<2>()(basis, {})});
    start = Eigen::VectorXd::Zero(null_space->full_size());
    if (null_space->rank() > 0) {
      start = StartingPoint<2>(pattern, *null_space, energies).smoothest();
    }
    const auto images = image_levels<2>(phantom.fixed, phantom.moving, nullptr, nullptr, 2,
                                        {.smooth_finest = true});
    for (const auto& image : images) {
      const std::shared_ptr<const BoundGrid<2>> grid = basis.bind(image.fixed.raster());
      auto weights = image.weights;
      keep_samples_inside<2>(*grid, {}, start.reshaped(2, pattern->size()), image.moving->raster(),
                             2, weights);
      std::shared_ptr<Metric<2>> compared = metric_of(metric)(metric_input(image, weights));
      const double unit = compared->unit();
      objective = std::make_unique<RegistrationObjective<2>>(
          pattern, std::make_shared<ImageTerm<2>>(grid, compared, AffineMap<2>()), unit, energies);
      if (&image == &images.back()) break;
      start = GaussNewton({.relative_decrease = 1e-2, .small_decreases = 1})
                  .minimize(*objective, start, null_space.get())
                  .x;
    }
    const auto best = GaussNewton({.relative_decrease = 1e-9, .max_iterations = 60})
                          .minimize(*objective, start, null_space.get());
    goal = best.value + 1e-3 * (best.initial_value - best.value);
  }

  std::optional<CreasedDomain> domain;
  std::unique_ptr<RegistrationObjective<2>> objective;
  std::shared_ptr<const NullSpace> null_space;
  Eigen::VectorXd start;
  double goal = 0;
};

Problem& problem_of(std::int64_t scene, std::int64_t metric) {
  static std::map<std::int64_t, std::unique_ptr<Problem>> problems;
  auto& problem = problems[10 * scene + metric];
  if (problem == nullptr) problem = std::make_unique<Problem>(static_cast<Scene>(scene), metric);
  return *problem;
}

std::unique_ptr<Optimizer> optimizer_of(std::int64_t kind) {
  const OptimizerOptions to_the_goal{
      .relative_decrease = 0, .relative_gradient = 0, .max_iterations = 2000};
  if (kind == 0) return std::make_unique<GaussNewton>(to_the_goal);
  if (kind == 1) return std::make_unique<Lbfgs>(to_the_goal);
  if (kind == 2) return std::make_unique<NonlinearConjugateGradient>(to_the_goal);
  if (kind == 3) return std::make_unique<SteepestDescent>(to_the_goal);
  if (kind == 4) return std::make_unique<Lbfgs>(to_the_goal, LbfgsOptions{.precondition = false});
  return std::make_unique<NonlinearConjugateGradient>(
      to_the_goal, NonlinearConjugateGradientOptions{.precondition = false});
}

void BM_Optimizer(benchmark::State& state) {
  static const char* const names[] = {"Gauss-Newton",
                                      "L-BFGS",
                                      "conjugate gradient",
                                      "steepest descent",
                                      "L-BFGS, not preconditioned",
                                      "conjugate gradient, not preconditioned"};
  const Threads threads(1);
  const Problem& problem = problem_of(state.range(0), state.range(1));
  const auto optimizer = optimizer_of(state.range(2));
  OptimizerResult result;
  double total = 0, evaluating = 0;
  for (auto _ : state) {
    Timed function(*problem.objective);
    double first = 0;  // when the first iteration, which also sets up, was over
    result = optimizer->minimize(function, problem.start, problem.null_space.get(),
                                 [&](const IterationRecord& record) {
                                   if (record.iteration == 1) {
                                     first = now();
                                     function.seconds = 0;
                                   }
                                   return record.value > problem.goal;
                                 });
    total += now() - first;
    evaluating += function.seconds;
  }
  state.counters["unknowns"] = static_cast<double>(problem.null_space->reduced_size());
  state.counters["reached"] = result.value <= problem.goal ? 1 : 0;
  state.counters["iterations"] = result.iterations;
  state.counters["passes"] = result.num_evaluations;
  state.counters["beside_%"] = total > 0 ? 100 * (total - evaluating) / total : 0;
  state.SetLabel(names[state.range(2)]);
}
BENCHMARK(BM_Optimizer)
    ->ArgNames({"scene", "metric", "optimizer"})
    ->ArgsProduct({{kBlobs, kFineBlobs, kSpine}, {0, 1, 2}, {0, 1, 2, 3, 4, 5}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace crease::benchmarks

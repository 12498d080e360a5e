#include "Registration/Elastic/LoadSteps.h"

#include <algorithm>
#include <cmath>

#include "Core/Quantiles.h"
#include "Registration/Elastic/ElasticEquilibrium.h"
#include "Registration/Elastic/ElasticPairs.h"
#include "Registration/LandmarkConstraints.h"

namespace crease {
namespace {

constexpr double kFirstAdaptiveStep = 0.25;
constexpr int kQuickIterations = 4;  // of a step after which a larger one is tried
constexpr double kLockingPoisson = 0.45;

void check_options(const LoadStepOptions& options) {
  const auto require = [](bool good, const char* name, double value, const char* range) {
    if (!good)
      throw InvalidInput(message("load steps: ", name, " = ", value, " is not ", range, "."));
  };
  require(options.steps >= 1 && options.steps <= 10000, "steps", options.steps,
          "between 1 and 10000");
  require(options.max_iterations >= 1, "max_iterations", options.max_iterations, "1 or more");
  require(options.tolerance > 0 && options.tolerance < 1, "tolerance", options.tolerance,
          "between 0 and 1");
  require(options.max_halvings >= 0 && options.max_halvings <= 30, "max_halvings",
          options.max_halvings, "between 0 and 30");
  require(options.max_failures >= 1, "max_failures", options.max_failures, "1 or more");
  require(options.snap_mm >= 0, "snap_mm", options.snap_mm, "0 or more");
}

void refuse_contradictions(const NullSpace& null_space, double tolerance) {
  const auto classes = classify_dependent_rows(null_space, tolerance);
  if (classes.contradictory.empty()) return;
  const DependentRow& row = classes.contradictory.front();
  throw InvalidInput(message("load steps: ", null_space.constraints().name(row.row),
                             " contradicts the others by ", row.residual.norm(), " mm."));
}

/// Warns of constraints that are held by far larger forces than the others.
void warn_of_reactions(const LinearConstraints& constraints, double suspicious,
                       LoadStepResult& result) {
  Eigen::VectorXd sizes = result.reactions.rowwise().norm();
  if (sizes.size() < 3) return;
  const double usual = median(std::vector<double>(sizes.begin(), sizes.end()));
  for (Eigen::Index r = 0; r < sizes.size(); ++r) {
    if (!(usual > 0) || sizes[r] <= suspicious * usual) continue;
    result.warnings.push_back(message(constraints.name(r), " is held by ", sizes[r] / usual,
                                      " times the median reaction (", sizes[r],
                                      " E mm): it may be wrong"));
  }
}

void warn_of_instability(LoadStepResult& result) {
  if (result.unstable) {
    result.warnings.push_back(message(
        "unstable equilibrium at load fraction ", result.fraction,
        ": the tangent is not positive definite, and a small push would let the body buckle. "
        "More pairs there hold it."));
    return;
  }
  for (const LoadStepRecord& record : result.steps) {
    if (!record.indefinite_tangent) continue;
    result.warnings.push_back(message("unstable equilibrium on the way, at load fraction ",
                                      record.fraction,
                                      ": beyond it the body may have buckled one way or another."));
    return;
  }
}

/// The sizes of the steps.
class StepSizes {
 public:
  explicit StepSizes(const LoadStepOptions& options)
      : adaptive_(options.schedule == LoadSchedule::kAdaptive),
        first_(adaptive_ ? kFirstAdaptiveStep : 1.0 / options.steps),
        least_(std::ldexp(first_, -options.max_halvings)),
        size_(first_) {}

  double next(double done) const {
    const double left = 1 - done;
    return left < size_ * (1 + 1e-9) ? left : size_;
  }
  void succeeded(int iterations) {
    if (iterations > kQuickIterations) return;
    if (adaptive_ || size_ < first_) size_ = std::min(2 * size_, adaptive_ ? 1.0 : first_);
  }
  /// Whether a smaller step is left to try.
  bool failed(double tried) {
    size_ = tried / 2;
    return size_ >= least_ * (1 - 1e-9);
  }

 private:
  bool adaptive_;
  double first_, least_, size_;
};

void set_state(const ElasticEquilibrium& body, LoadStepResult& result) {
  result.control_points = body.control_points();
  result.energy = body.energy();
  result.reactions = body.reactions();
  result.least_determinant = body.least_determinant();
  result.factorizations = body.num_factorizations();
}

/// What is told of the state that a run ends with.
void judge_state(ElasticEquilibrium& body, const LinearConstraints& constraints,
                 const LoadStepOptions& options, LoadStepResult& result) {
  result.unstable = !body.stable();
  result.factorizations = body.num_factorizations();
  warn_of_reactions(constraints, options.suspicious_reaction, result);
  warn_of_instability(result);
}

[[noreturn]] void give_up(const std::string& reason, LoadStepResult result) {
  const std::string text = message(
      "no elastic equilibrium beyond load fraction ", result.fraction, ": ", reason,
      ". More pairs there, plane stress or neo-Hookean tissue may help; so may a look at the pairs "
      "with the largest reactions.");
  throw NoEquilibrium(text, std::move(result));
}

LandmarkOptions pair_options() {
  LandmarkOptions options;
  options.words.noun = "pair";
  options.words.remedies =
      "correct or delete some of them, or use smaller triangles there (--mesh-size, or more "
      "--triangles)";
  return options;
}

/// Rows of the pairs' constraints, by their names.
LinearConstraints pair_constraints(const ElasticDeformation& deformation, const Landmarks<2>& pairs,
                                   NullSpaceKind kind, std::vector<int>& independent,
                                   std::vector<std::string>& warnings) {
  const LandmarkOptions options = pair_options();
  const auto found =
      make_landmark_constraints<2>(pairs, *deformation.basis, deformation.affine, options, kind);
  warnings.insert(warnings.end(), found.notes.begin(), found.notes.end());
  independent = found.null_space->independent_rows();
  LinearConstraints constraints = found.null_space->constraints();
  for (std::size_t j = 0; j < constraints.names.size(); ++j) {
    constraints.names[j] = options.words.one(static_cast<int>(j));
  }
  return constraints;
}

/// By cells with the degree that is exact at rest.
double quadrature_error(const ElasticEnergy<2>& energy, const ElasticDeformation& deformation) {
  const SplineBasis<2>& basis = *deformation.basis;
  const ElasticOptions<2> exact{.quadrature_degree = basis.product_degree(2, 1)};
  return relative_tangent_difference(
      energy, ElasticEnergy<2>(basis, deformation.material, deformation.affine, exact));
}

void warn_of_locking(const ElasticDeformation& deformation, std::vector<std::string>& warnings) {
  const ElasticMaterial& material = deformation.material;
  double largest = material.tissue.poisson;
  for (const auto& [region, tissue] : material.regions) largest = std::max(largest, tissue.poisson);
  if (deformation.basis->degree() > 1 || material.plane == PlaneState::kStress ||
      largest <= kLockingPoisson) {
    return;
  }
  warnings.push_back(message("splines of degree 1 lock in plane strain with nu = ", largest, " > ",
                             kLockingPoisson, "; use degree 2"));
}

/// @param result  with what is known beforehand, such as warnings; it is filled, and part of a failure.
LoadStepResult load(const ElasticEnergy<2>& energy, const SplineBasis<2>& basis,
                    const LinearConstraints& constraints, const LoadStepOptions& options,
                    const LoadStepCallback& progress, LoadStepResult result) {
  const Eigen::Index m =
      constraints.d.cols() == 2 ? basis.num_control_points() : 2 * basis.num_control_points();
  const auto null_space = make_null_space(options.null_space, constraints, m);
  refuse_contradictions(*null_space, 1e-6 * basis.mean_edge_length());
  ElasticEquilibrium body(energy, *null_space, options);
  set_state(body, result);
  StepSizes sizes(options);
  while (result.fraction < 1) {
    const double share = sizes.next(result.fraction);
    LoadStepRecord record;
    if (const auto failure = body.advance(share, basis, record)) {
      if (++result.failures < options.max_failures && sizes.failed(share)) continue;
      judge_state(body, constraints, options, result);
      give_up(*failure, std::move(result));
    }
    sizes.succeeded(record.newton_iterations);
    const double fraction = result.fraction + share;
    result.fraction = record.fraction = fraction > 1 - 1e-12 ? 1.0 : fraction;
    record.step = static_cast<int>(result.steps.size()) + 1;
    result.steps.push_back(record);
    set_state(body, result);
    if (progress && !progress(record)) break;
  }
  judge_state(body, constraints, options, result);
  return result;
}

}  // namespace

LoadStepResult run_load_steps(const ElasticEnergy<2>& energy, const SplineBasis<2>& basis,
                              const LinearConstraints& constraints, const LoadStepOptions& options,
                              const LoadStepCallback& progress) {
  check_options(options);
  return load(energy, basis, constraints, options, progress, {});
}

LoadStepResult deform_elastically(const ElasticDeformation& deformation,
                                  const LoadStepOptions& options,
                                  const LoadStepCallback& progress) {
  if (!deformation.basis) throw InvalidInput("elastic deformation: there is no basis.");
  check_options(options);
  const SplineBasis<2>& basis = *deformation.basis;
  Landmarks<2> pairs = deformation.pairs;
  pairs.sigma_mm.clear();  // all are met exactly
  LoadStepResult result;
  result.warnings = snap_to_domain(pairs, basis, options.snap_mm);
  const auto contours = deformation.contour.empty()
                            ? pairs_along_border(pairs, basis, options.snap_mm)
                            : std::vector<std::vector<int>>{deformation.contour};
  for (const auto& contour : contours) check_no_crossing(pairs, contour);
  warn_of_locking(deformation, result.warnings);
  std::vector<int> independent;
  const LinearConstraints constraints =
      pair_constraints(deformation, pairs, options.null_space, independent, result.warnings);
  check_no_floating_part(pairs, independent, basis);
  const ElasticEnergy<2> energy(basis, deformation.material, deformation.affine,
                                {.quadrature = deformation.quadrature});
  if (deformation.quadrature != ElasticQuadrature::kCells) {
    result.quadrature_error = quadrature_error(energy, deformation);
  }
  return load(energy, basis, constraints, options, progress, std::move(result));
}

SplineTransform<2> transform_of(const ElasticDeformation& deformation,
                                const LoadStepResult& result) {
  SplineTransform<2> transform(deformation.basis, deformation.affine);
  transform.set_control_points(result.control_points);
  return transform;
}

}  // namespace crease

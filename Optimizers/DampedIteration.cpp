#include "Optimizers/DampedIteration.h"

#include "Core/Error.h"
#include "Optimizers/Minimization.h"
#include "Optimizers/SparseCholesky.h"

namespace crease {

DampedIteration::DampedIteration(const Eigen::SparseMatrix<double>& M,
                                 const OptimizerOptions& stopping,
                                 const DampedIterationOptions& options)
    : M_(M), stopping_(stopping), options_(options) {
  check_options(stopping);
  if (!(options.step > 0 && options.step <= 1) || options.max_halvings < 0) {
    throw InvalidInput(message("damped iteration: need 0 < step <= 1 (is ", options.step,
                               "), max_halvings >= 0 (", options.max_halvings, ")."));
  }
}

OptimizerResult DampedIteration::minimize(ObjectiveFunction& function, const Eigen::VectorXd& start,
                                          const NullSpace* null_space,
                                          const ProgressCallback& progress) const {
  Minimization run(function, start, null_space, stopping_, progress, /*with_hessian=*/false);
  Eigen::SparseMatrix<double> reduced;
  run.null_space().reduce_hessian(M_, reduced);
  SparseCholesky factor;
  if (!factor.factor(reduced)) {
    throw SolverError(
        "damped iteration: the matrix is not positive definite; constrain what can still move "
        "freely.");
  }
  run.set_linear_work(1, 0);
  double h = options_.step;
  int halvings = 0;
  while (!run.stopped()) {
    const EvaluatedPoint& here = run.current();
    const Eigen::VectorXd direction = -factor.solve(here.gradient);
    while (!run.out_of_time()) {
      if (run.evaluate_trial(here.y + h * direction).value < here.value) {
        run.accept_trial(h);
        break;
      }
      run.reject_trial(-h * here.gradient.dot(direction));
      if (run.stopped()) break;
      if (halvings == options_.max_halvings) {
        throw SolverError(message("damped iteration: the value still grows with a step of ", h,
                                  ", halved ", halvings,
                                  " times; lower the weight of the images, or take Gauss-Newton."));
      }
      h /= 2;
      ++halvings;
    }
  }
  return run.result();
}

}  // namespace crease

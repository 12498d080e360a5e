#include "Testing/Optimizers/GslMinimum.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multimin.h>

#include <memory>

namespace crease::testing {
namespace {

struct Problem {
  ObjectiveFunction& function;
  const NullSpace& null_space;

  double evaluate(const gsl_vector* y, gsl_vector* gradient) const {
    const Eigen::Map<const Eigen::VectorXd> at(y->data, static_cast<Eigen::Index>(y->size));
    Eigen::VectorXd full;
    const double value = function.evaluate(null_space.expand(at), &full, nullptr);
    if (gradient != nullptr) {
      Eigen::Map<Eigen::VectorXd>(gradient->data, at.size()) = null_space.apply_transpose(full);
    }
    return value;
  }
};

const Problem& problem_of(void* data) { return *static_cast<const Problem*>(data); }

}  // namespace

GslMinimum gsl_minimum(GslMethod method, ObjectiveFunction& function, const NullSpace& null_space,
                       const Eigen::VectorXd& start) {
  gsl_set_error_handler_off();
  Problem problem{function, null_space};
  Eigen::VectorXd y = null_space.coordinates(start);
  const auto size = static_cast<std::size_t>(y.size());
  gsl_multimin_function_fdf gsl{
      [](const gsl_vector* v, void* data) { return problem_of(data).evaluate(v, nullptr); },
      [](const gsl_vector* v, void* data, gsl_vector* g) { problem_of(data).evaluate(v, g); },
      [](const gsl_vector* v, void* data, double* f, gsl_vector* g) {
        *f = problem_of(data).evaluate(v, g);
      },
      size, &problem};
  const std::unique_ptr<gsl_multimin_fdfminimizer, decltype(&gsl_multimin_fdfminimizer_free)>
      minimizer(gsl_multimin_fdfminimizer_alloc(method == GslMethod::kBfgs
                                                    ? gsl_multimin_fdfminimizer_vector_bfgs2
                                                    : gsl_multimin_fdfminimizer_conjugate_pr,
                                                size),
                &gsl_multimin_fdfminimizer_free);
  const gsl_vector_const_view first = gsl_vector_const_view_array(y.data(), size);
  int status = gsl_multimin_fdfminimizer_set(minimizer.get(), &gsl, &first.vector, /*step=*/0.1,
                                             /*tol=*/0.1);
  for (int i = 0; i < 2000 && status == GSL_SUCCESS; ++i) {
    status = gsl_multimin_fdfminimizer_iterate(minimizer.get());
    if (gsl_multimin_test_gradient(minimizer->gradient, 1e-7) == GSL_SUCCESS) break;
  }
  const Eigen::Map<const Eigen::VectorXd> found(minimizer->x->data, y.size());
  const Eigen::Map<const Eigen::VectorXd> gradient(minimizer->gradient->data, y.size());
  return {minimizer->f, null_space.expand(found), gradient.norm()};
}

}  // namespace crease::testing

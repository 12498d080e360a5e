#include "Optimizers/LinearConjugateGradient.h"

#include <cmath>

namespace crease {

LinearConjugateGradientResult linear_conjugate_gradient(
    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& apply,
    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& precondition,
    const Eigen::Ref<const Eigen::VectorXd>& b, const LinearConjugateGradientOptions& options) {
  LinearConjugateGradientResult result{.x = Eigen::VectorXd::Zero(b.size())};
  Eigen::VectorXd r = b;
  Eigen::VectorXd z = precondition(r);
  Eigen::VectorXd p = z;
  double rz = r.dot(z);
  if (rz == 0.0 && r.isZero(0.0)) {
    result.converged = true;
    return result;
  }
  const double goal = options.tolerance * options.tolerance * rz;
  while (true) {
    if (!(rz > 0.0) || !std::isfinite(rz)) {
      result.breakdown = true;
      return result;
    }
    if (result.iterations == options.max_iterations) return result;
    const Eigen::VectorXd Ap = apply(p);
    const double curvature = p.dot(Ap);
    if (!(curvature > 0.0) || !std::isfinite(curvature)) {
      result.breakdown = true;
      return result;
    }
    const double length = rz / curvature;
    result.x += length * p;
    r -= length * Ap;
    ++result.iterations;
    z = precondition(r);
    const double next = r.dot(z);
    if (next <= goal) {
      result.converged = true;
      return result;
    }
    p = z + (next / rz) * p;
    rz = next;
  }
}

}  // namespace crease

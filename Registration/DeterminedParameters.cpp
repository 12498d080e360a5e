#include "Registration/DeterminedParameters.h"

#include <algorithm>
#include <random>

namespace crease {
namespace {

constexpr int kProbes = 3;

Eigen::SparseMatrix<double> reduced_hessian(ObjectiveFunction& function, const Eigen::VectorXd& phi,
                                            const NullSpace& null_space) {
  Eigen::SparseMatrix<double> full, reduced;
  Eigen::VectorXd gradient;
  function.evaluate(phi, &gradient, &full);
  null_space.reduce_hessian(full, reduced);
  return reduced;
}

}  // namespace

double determined_parameters(ObjectiveFunction& image, ObjectiveFunction& whole,
                             const Eigen::VectorXd& phi, const NullSpace& null_space,
                             DampedSolver& solver) {
  constexpr double kDamping = 1e-9;  // directions that nothing determines count as not determined
  const Eigen::SparseMatrix<double> J = reduced_hessian(image, phi, null_space);
  solver.hessian() = reduced_hessian(whole, phi, null_space);
  solver.hessian_changed();
  std::minstd_rand random(1);
  double sum = 0;
  for (int probe = 0; probe < kProbes; ++probe) {
    Eigen::VectorXd z(J.cols());
    for (double& sign : z) sign = random() & 1024 ? 1.0 : -1.0;
    const Eigen::VectorXd Jz = J.selfadjointView<Eigen::Lower>() * z;
    const auto x = solver.solve(Jz, kDamping);
    if (!x) return static_cast<double>(J.cols());
    sum += z.dot(*x);
  }
  return std::clamp(sum / kProbes, 0.0, static_cast<double>(J.cols()));
}

}  // namespace crease

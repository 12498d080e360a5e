#include "Registration/DeterminedParameters.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "Optimizers/EliminationNullSpace.h"

namespace crease {
namespace {

/// 1/2 x^T A x.
class Quadratic final : public ObjectiveFunction {
 public:
  explicit Quadratic(Eigen::MatrixXd A) : A_(std::move(A)) {}
  Eigen::Index size() const override { return A_.cols(); }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    if (gradient != nullptr) *gradient = A_ * x;
    if (hessian != nullptr) {
      *hessian = Eigen::MatrixXd(A_.triangularView<Eigen::Lower>()).sparseView();
    }
    return 0.5 * x.dot(A_ * x);
  }

 private:
  Eigen::MatrixXd A_;
};

constexpr int kSize = 400;

std::unique_ptr<NullSpace> constrained(int rows) {
  LinearConstraints constraints;
  constraints.C.resize(rows, kSize / 2);
  for (int r = 0; r < rows; ++r) constraints.C.insert(r, 3 * r) = 1;
  constraints.C.makeCompressed();
  constraints.d = RowMatrix::Zero(rows, 2);
  return make_null_space(NullSpaceKind::kElimination, constraints, kSize / 2);
}

double count(const Eigen::VectorXd& image, const Eigen::VectorXd& energies,
             const NullSpace& space) {
  Quadratic of_image{Eigen::MatrixXd(image.asDiagonal())};
  Quadratic whole{Eigen::MatrixXd((image + energies).asDiagonal())};
  DampedSolver solver({.kind = LinearSolver::kDirect}, 2);
  return determined_parameters(of_image, whole, Eigen::VectorXd::Zero(kSize), space, solver);
}

// Of a diagonal matrix Hutchinson's probes give the trace itself.
TEST(DeterminedParameters, AreCountedOneByOne) {
  Eigen::VectorXd image = Eigen::VectorXd::Zero(kSize);
  image.head(100).setConstant(3.0);
  const Eigen::VectorXd energies = Eigen::VectorXd::Constant(kSize, 1.0);
  EXPECT_NEAR(count(image, energies, *constrained(0)), 75.0, 1e-6);
  // Control points 0, 3, .. 27 are constrained, with two parameters each.
  EXPECT_NEAR(count(image, energies, *constrained(10)), 60.0, 1e-6);
}

TEST(DeterminedParameters, AreAllOrNone) {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(kSize);
  EXPECT_NEAR(count(one, 0 * one, *constrained(0)), kSize, 1e-4);
  EXPECT_NEAR(count(0 * one, one, *constrained(0)), 0.0, 1e-6);
}

// Coupled parameters: the estimate lies within three of its standard deviations, (2 trace / probes)^1/2.
TEST(DeterminedParameters, AreEstimatedWhereTheyAreCoupled) {
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(kSize, kSize / 4);
  const Eigen::MatrixXd J = root * root.transpose();
  const Eigen::MatrixXd P = 20.0 * Eigen::MatrixXd::Identity(kSize, kSize);
  const double expected = (J + P).llt().solve(J).trace();
  Quadratic of_image(J), whole(J + P);
  DampedSolver solver({.kind = LinearSolver::kDirect}, 2);
  const double found =
      determined_parameters(of_image, whole, Eigen::VectorXd::Zero(kSize), *constrained(0), solver);
  EXPECT_GT(expected, 50);
  EXPECT_NEAR(found, expected, 3 * std::sqrt(2 * expected / 3));
}

}  // namespace
}  // namespace crease

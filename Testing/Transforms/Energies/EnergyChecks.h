#pragma once

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "Testing/Gradients.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Energies/Energy.h"

namespace crease::testing {

template <int Dim>
std::shared_ptr<const HessianPattern> pattern_of(const SplineBasis<Dim>& basis) {
  return std::make_shared<HessianPattern>(basis.num_control_points(), basis.couplings());
}

/// The energy's Hessian, both triangles.
template <int Dim>
Eigen::MatrixXd dense_hessian(const Energy<Dim>& energy, const SplineBasis<Dim>& basis,
                              const ControlPoints<Dim>& phi) {
  BlockHessian<Dim> hessian(pattern_of(basis));
  energy.evaluate(phi, 1, nullptr, &hessian);
  const Eigen::MatrixXd lower = hessian.to_sparse();
  return lower.selfadjointView<Eigen::Lower>();
}

/// The gradient's slope in a random direction against central differences of the value.
template <int Dim>
void expect_gradient(const Energy<Dim>& energy, const ControlPoints<Dim>& phi,
                     const std::string& what) {
  ControlPoints<Dim> gradient = ControlPoints<Dim>::Zero(Dim, phi.cols());
  energy.evaluate(phi, 1, &gradient, nullptr);
  const ControlPoints<Dim> direction = Numbers(4).columns<Dim>(phi.cols());
  expect_slope([&](double t) { return energy.evaluate(phi + t * direction, 1, nullptr, nullptr); },
               gradient.cwiseProduct(direction).sum(), what);
}

/// Central differences of the gradient against the Hessian, relative.
template <int Dim>
double hessian_error(const Energy<Dim>& energy, const SplineBasis<Dim>& basis,
                     const ControlPoints<Dim>& phi, double step = 1e-5) {
  const Eigen::MatrixXd hessian = dense_hessian(energy, basis, phi);
  const ControlPoints<Dim> direction = Numbers(6).columns<Dim>(phi.cols());
  ControlPoints<Dim> plus = ControlPoints<Dim>::Zero(Dim, phi.cols()), minus = plus;
  energy.evaluate(phi + step * direction, 1, &plus, nullptr);
  energy.evaluate(phi - step * direction, 1, &minus, nullptr);
  const Eigen::VectorXd expected = ((plus - minus) / (2 * step)).reshaped();
  const Eigen::VectorXd found = hessian * Eigen::VectorXd(direction.reshaped());
  return (found - expected).norm() / expected.norm();
}

inline double smallest_eigenvalue(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

/// `scale` multiplies what is added, not the value; both are added to what is there.
template <int Dim>
void expect_scaled(const Energy<Dim>& energy, const SplineBasis<Dim>& basis,
                   const ControlPoints<Dim>& phi) {
  ControlPoints<Dim> once = ControlPoints<Dim>::Zero(Dim, phi.cols()), thrice = once;
  BlockHessian<Dim> h_once(pattern_of(basis)), h_thrice(pattern_of(basis));
  const double value = energy.evaluate(phi, 1, &once, &h_once);
  EXPECT_NEAR(energy.evaluate(phi, 2, &thrice, &h_thrice), value, 1e-14 * std::abs(value));
  energy.evaluate(phi, 1, &thrice, &h_thrice);
  EXPECT_LT((thrice - 3 * once).norm(), 1e-12 * once.norm());
  EXPECT_LT((h_thrice.to_sparse() - 3 * h_once.to_sparse()).norm(),
            1e-12 * h_once.to_sparse().norm());
}

}  // namespace crease::testing

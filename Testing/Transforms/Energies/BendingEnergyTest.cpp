#include "Transforms/Energies/BendingEnergy.h"

#include <gmock/gmock.h>

#include "Core/Parallel.h"
#include "Testing/Transforms/Energies/EnergyChecks.h"
#include "Transforms/Energies/DirichletEnergy.h"
#include "Transforms/SplineProjection.h"

namespace crease {
namespace {

using testing::box_basis;
using testing::small_basis;

template <int Dim>
ControlPoints<Dim> random_points(const SplineBasis<Dim>& basis) {
  return testing::Numbers(8).columns<Dim>(basis.num_control_points());
}

template <int Dim>
void expect_no_energy_of_affine_maps() {
  const auto basis = small_basis<Dim>();
  AffineMap<Dim> map;
  map.linear += 0.3 * Matrix<Dim>::Random();
  map.offset.setConstant(5);
  const auto phi = testing::affine_control_points<Dim>(*basis, map);
  EXPECT_LT(BendingEnergy<Dim>(*basis).evaluate(phi, 1, nullptr, nullptr), 1e-12);
}

template <int Dim>
void expect_right_hessian() {
  const auto basis = small_basis<Dim>();
  const BendingEnergy<Dim> energy(
      *basis, [](const Point<Dim>& x, int) { return 0.5 + 0.5 * std::sin(x[0] + 2 * x[1]); });
  const auto phi = random_points<Dim>(*basis);
  EXPECT_LT(testing::hessian_error<Dim>(energy, *basis, phi, 1e-2), 1e-8);
  testing::expect_scaled<Dim>(energy, *basis, phi);
  const Eigen::MatrixXd k = energy.matrix();
  EXPECT_LT((k - k.transpose()).norm(), 1e-14 * k.norm());
  EXPECT_GT(testing::smallest_eigenvalue(k), -1e-12 * k.norm());
}

}  // namespace

TEST(BendingEnergy, IsZeroForAffineMaps) {
  expect_no_energy_of_affine_maps<2>();
  expect_no_energy_of_affine_maps<3>();
}

// u = (x^2, 0): u_xx = 2, E_S = 1/2 * 4 * area.
TEST(BendingEnergy, OfAParabolaIsTwiceTheArea) {
  for (int degree : {2, 3, 5}) {
    const auto basis = box_basis<2>(5, 4.0, degree);
    const auto fit =
        project<2>(*basis, [](const Point<2>& x) { return Vector<2>(x[0] * x[0], 0); });
    const double energy =
        BendingEnergy<2>(*basis).evaluate(fit.control_points, 1, nullptr, nullptr);
    EXPECT_NEAR(energy, 2 * 16, 1e-10 * 32);
  }
  const auto basis = box_basis<3>(3, 2.0);
  const auto fit =
      project<3>(*basis, [](const Point<3>& x) { return Vector<3>(x[0] * x[0], 0, 0); });
  EXPECT_NEAR(BendingEnergy<3>(*basis).evaluate(fit.control_points, 1, nullptr, nullptr), 2 * 8,
              1e-10 * 16);
}

// u = (xy, 0, xz - yz): all mixed derivatives count twice: E_S = 1/2 * 2 * (1 + 1 + 1) * volume.
TEST(BendingEnergy, CountsMixedDerivativesTwice) {
  const auto basis = box_basis<3>(3, 2.0, 2);
  const auto fit = project<3>(*basis, [](const Point<3>& x) {
    return Vector<3>(x[0] * x[1], 0, x[0] * x[2] - x[1] * x[2]);
  });
  const double energy = BendingEnergy<3>(*basis).evaluate(fit.control_points, 1, nullptr, nullptr);
  EXPECT_NEAR(energy, 3 * 8, 1e-10 * 24);
}

TEST(BendingEnergy, CountsOnlyTheSoftPart) {
  const auto basis = box_basis<2>(4, 4.0);
  const auto fit = project<2>(*basis, [](const Point<2>& x) { return Vector<2>(x[0] * x[0], 0); });
  const BendingEnergy<2> half(*basis, [](const Point<2>& x, int) { return x[0] < 2 ? 1.0 : 0.0; });
  EXPECT_NEAR(half.evaluate(fit.control_points, 1, nullptr, nullptr), 16, 1e-9);
  const BendingEnergy<2> tenth(*basis, [](const Point<2>&, int) { return 0.9; });
  EXPECT_NEAR(tenth.evaluate(fit.control_points, 1, nullptr, nullptr), 0.32, 1e-10);
}

TEST(BendingEnergy, HessianIsExact) {
  expect_right_hessian<2>();
  expect_right_hessian<3>();
}

TEST(BendingEnergy, RefusesDegreeOneAndBadWeights) {
  EXPECT_THAT([] { BendingEnergy<2>{*small_basis<2>(1)}; },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("DirichletEnergy")));
  EXPECT_THAT(
      [] {
        BendingEnergy<2>(*small_basis<2>(),
                         [](const Point<2>& x, int) { return x[0] > 5 ? 1.5 : 0.0; });
      },
      ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("found 0 to 1.5")));
  EXPECT_THROW(
      BendingEnergy<2>(*small_basis<2>(), [](const Point<2>&, int) { return std::nan(""); }),
      InvalidInput);
  const BendingEnergy<2> energy(*small_basis<2>());
  EXPECT_THROW(energy.evaluate(ControlPoints<2>::Zero(2, 3), 1, nullptr, nullptr), InvalidInput);
}

TEST(BendingEnergy, SameBytesOnAnyNumberOfThreads) {
  const auto basis = small_basis<3>();
  set_num_threads(1);
  const Eigen::VectorXd one = BendingEnergy<3>(*basis).matrix().coeffs();
  set_num_threads(4);
  const Eigen::VectorXd four = BendingEnergy<3>(*basis).matrix().coeffs();
  set_num_threads(0);
  EXPECT_EQ(one, four);
}

// u = L x - x: E_D = 1/2 |L - I|^2 * area.
TEST(DirichletEnergy, OfAnAffineMap) {
  for (int degree : {1, 3}) {
    const auto basis = box_basis<2>(3, 2.0, degree);
    AffineMap<2> map;
    map.linear << 1.2, 0.3, -0.1, 0.7;
    const auto phi = testing::affine_control_points<2>(*basis, map);
    const DirichletEnergy<2> energy(*basis);
    EXPECT_NEAR(energy.evaluate(phi, 1, nullptr, nullptr),
                0.5 * (map.linear - Matrix<2>::Identity()).squaredNorm() * 4, 1e-12);
    testing::expect_scaled<2>(energy, *basis, phi);
  }
}

}  // namespace crease

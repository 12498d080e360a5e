#include "Transforms/Energies/RigidityEnergy.h"

#include <gmock/gmock.h>

#include "Core/Parallel.h"
#include "Testing/Transforms/Energies/EnergyChecks.h"
#include "Transforms/RigidTransform.h"

namespace crease {
namespace {

using testing::box_basis;
using testing::small_basis;

template <int Dim>
AffineMap<Dim> some_rigid_map() {
  RigidTransform<Dim> rigid(Point<Dim>::Constant(2));
  Eigen::VectorXd p = Eigen::VectorXd::LinSpaced(rigid.num_parameters(), 0.7, 2.3);
  rigid.set_parameters(p);
  return rigid.affine_map();
}

template <int Dim>
WeightField<Dim> smooth_weights() {
  return [](const Point<Dim>& x, int) { return 0.5 + 0.5 * std::sin(x[0] - x[1]); };
}

template <int Dim>
ControlPoints<Dim> random_points(const SplineBasis<Dim>& basis, double size = 0.4) {
  return testing::Numbers(8).columns<Dim>(basis.num_control_points(), size);
}

template <typename T>
class RigidityEnergySuite : public ::testing::Test {};

}  // namespace

template <int N>
using Dimension = std::integral_constant<int, N>;
using Dimensions = ::testing::Types<Dimension<2>, Dimension<3>>;
TYPED_TEST_SUITE(RigidityEnergySuite, Dimensions);

TYPED_TEST(RigidityEnergySuite, IsZeroForRigidMotions) {
  constexpr int kDim = TypeParam::value;
  const auto basis = small_basis<kDim>();
  const RigidityEnergy<kDim> energy(*basis, nullptr);
  const auto phi = testing::affine_control_points<kDim>(*basis, some_rigid_map<kDim>());
  EXPECT_GT(phi.norm(), 1);
  EXPECT_LT(energy.evaluate(phi, 1, nullptr, nullptr), 1e-14 * basis->measure());
  EXPECT_NEAR(energy.weighted_measure(), basis->measure(), 1e-12 * basis->measure());
}

TYPED_TEST(RigidityEnergySuite, OfAStretchIsKnown) {
  constexpr int kDim = TypeParam::value;
  const auto basis = small_basis<kDim>(2);
  const RigidityEnergy<kDim> energy(*basis, nullptr);
  for (double s : {0.5, 1.3, 2.0}) {
    AffineMap<kDim> stretch;
    stretch.linear(0, 0) = s;
    const double expected = basis->measure() * std::pow(s * s - 1, 2) / 8;
    const auto phi = testing::affine_control_points<kDim>(*basis, stretch);
    EXPECT_NEAR(energy.evaluate(phi, 1, nullptr, nullptr), expected, 1e-12 * expected);
  }
}

// The affine part of T counts like a spline that does the same, and a rotated one costs nothing.
TYPED_TEST(RigidityEnergySuite, RespectsTheAffinePart) {
  constexpr int kDim = TypeParam::value;
  const auto basis = small_basis<kDim>();
  const auto rest = ControlPoints<kDim>::Zero(kDim, basis->num_control_points()).eval();
  const RigidityEnergy<kDim> rotated(*basis, nullptr, some_rigid_map<kDim>());
  EXPECT_LT(rotated.evaluate(rest, 1, nullptr, nullptr), 1e-14 * basis->measure());

  AffineMap<kDim> shear;
  shear.linear(0, 1) = 0.4;
  const auto phi = random_points<kDim>(*basis);
  const ControlPoints<kDim> all = phi + testing::affine_control_points<kDim>(*basis, shear);
  const double together = RigidityEnergy<kDim>(*basis, nullptr).evaluate(all, 1, nullptr, nullptr);
  const double apart =
      RigidityEnergy<kDim>(*basis, nullptr, shear).evaluate(phi, 1, nullptr, nullptr);
  EXPECT_NEAR(together, apart, 1e-12 * together);
}

TYPED_TEST(RigidityEnergySuite, ExactHessianMatchesCentralDifferences) {
  constexpr int kDim = TypeParam::value;
  const auto basis = small_basis<kDim>(2);
  const RigidityEnergy<kDim> energy(*basis, smooth_weights<kDim>(), {}, {.exact_hessian = true});
  const auto phi = random_points<kDim>(*basis);
  EXPECT_LT(testing::hessian_error<kDim>(energy, *basis, phi), 1e-6);
  testing::expect_scaled<kDim>(energy, *basis, phi);
}

TYPED_TEST(RigidityEnergySuite, GaussNewtonHessianIsPositiveSemiDefinite) {
  constexpr int kDim = TypeParam::value;
  const auto basis = small_basis<kDim>(2);
  const RigidityEnergy<kDim> energy(*basis, smooth_weights<kDim>());
  const auto hessian = testing::dense_hessian<kDim>(energy, *basis, random_points<kDim>(*basis));
  EXPECT_GT(testing::smallest_eigenvalue(hessian), -1e-12 * hessian.norm());
}

// Where the strain is zero the neglected term is, too.
TYPED_TEST(RigidityEnergySuite, GaussNewtonHessianIsExactAtRigidMotions) {
  constexpr int kDim = TypeParam::value;
  const auto basis = small_basis<kDim>(2);
  const RigidityEnergy<kDim> energy(*basis, smooth_weights<kDim>());
  const auto phi = testing::affine_control_points<kDim>(*basis, some_rigid_map<kDim>());
  EXPECT_LT(testing::hessian_error<kDim>(energy, *basis, phi), 1e-6);
}

TYPED_TEST(RigidityEnergySuite, SameBytesOnAnyNumberOfThreads) {
  constexpr int kDim = TypeParam::value;
  const auto basis = small_basis<kDim>();
  const RigidityEnergy<kDim> energy(*basis, smooth_weights<kDim>());
  const auto phi = random_points<kDim>(*basis);
  const auto run = [&] {
    ControlPoints<kDim> gradient = 0 * phi;
    BlockHessian<kDim> hessian(testing::pattern_of<kDim>(*basis));
    const double value = energy.evaluate(phi, 1, &gradient, &hessian);
    return std::tuple(value, gradient, Eigen::VectorXd(hessian.to_sparse().coeffs()));
  };
  set_num_threads(1);
  const auto one = run();
  set_num_threads(4);
  const auto four = run();
  set_num_threads(0);
  EXPECT_EQ(one, four);
}

TEST(RigidityEnergy, ActsWhereTheWeightIs) {
  const auto basis = box_basis<2>(4, 4.0);
  AffineMap<2> stretch;
  stretch.linear(1, 1) = 1.5;
  const auto phi = testing::affine_control_points<2>(*basis, stretch);
  const double full = RigidityEnergy<2>(*basis, nullptr).evaluate(phi, 1, nullptr, nullptr);
  const RigidityEnergy<2> quarter(*basis, [](const Point<2>& x, int) { return x[0] < 1 ? 1 : 0; });
  EXPECT_NEAR(quarter.evaluate(phi, 1, nullptr, nullptr), full / 4, 1e-12);
  EXPECT_NEAR(quarter.weighted_measure(), 4, 1e-12);
  const RigidityEnergy<2> chosen(*basis, nullptr, {},
                                 {.wanted = [](int, int patch) { return patch < 8; }});
  EXPECT_NEAR(chosen.evaluate(phi, 1, nullptr, nullptr), full / 2, 1e-12);
  // A tensor lattice knows no bodies, so by default nothing is rigid.
  EXPECT_EQ(RigidityEnergy<2>(*basis).evaluate(phi, 1, nullptr, nullptr), 0);
}

TEST(RigidityEnergy, RefusesBadInput) {
  const auto basis = small_basis<2>();
  EXPECT_THAT([&] { RigidityEnergy<2>(*basis, [](const Point<2>&, int) { return -0.25; }); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("found -0.25 to -0.25")));
  const RigidityEnergy<2> energy(*basis, nullptr);
  EXPECT_THROW(energy.evaluate(ControlPoints<2>::Zero(2, 3), 1, nullptr, nullptr), InvalidInput);
}

}  // namespace crease

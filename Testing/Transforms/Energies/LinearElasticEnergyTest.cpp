#include "Transforms/Energies/LinearElasticEnergy.h"

#include "Core/Parallel.h"
#include "Testing/Transforms/Energies/EnergyChecks.h"
#include "Testing/Transforms/SampleBases.h"
#include "Transforms/Splines/KnotLocator.h"

namespace crease {
namespace {

template <int Dim>
Box<Dim> test_box() {
  Box<Dim> box;
  box.add(Point<Dim>::Constant(-1));
  box.add(Point<Dim>::Constant(5));
  return box;
}

/// Control points of v(x) = G x + t.
template <int Dim>
ControlPoints<Dim> gradient_field(const SplineBasis<Dim>& basis, const Matrix<Dim>& G) {
  AffineMap<Dim> map;
  map.linear = Matrix<Dim>::Identity() + G;
  map.offset.setConstant(3);
  return testing::affine_control_points<Dim>(basis, map);
}

template <int Dim>
double energy_of(const LinearElasticEnergy<Dim>& energy, const ControlPoints<Dim>& phi) {
  return energy.evaluate(phi, 1, nullptr, nullptr);
}

/// Energy density of a constant strain.
template <int Dim>
double density(const Matrix<Dim>& G, const LameParameters& lame) {
  const Matrix<Dim> strain = 0.5 * (G + G.transpose());
  return 0.5 * (lame.lambda * std::pow(strain.trace(), 2) + 2 * lame.mu * strain.squaredNorm());
}

template <int Dim>
void expect_constant_strains() {
  const auto box = test_box<Dim>();
  Matrix<Dim> G = Matrix<Dim>::Identity() * 0.2;
  G(0, 1) = 0.3;
  G(1, 0) = -0.1;
  G(1, 1) = -0.4;
  for (double nu : {-0.5, 0.0, 0.3, 0.495}) {
    const ElasticMaterial material{.tissue = {7, nu}};
    const auto lame =
        lame_parameters(material.tissue, Dim == 2 ? PlaneState::kStress : PlaneState::kStrain);
    for (const auto& sample : testing::sample_bases<Dim>(box)) {
      if (!sample.integrates) continue;
      const LinearElasticEnergy<Dim> energy(*sample.basis, material);
      const double expected = density<Dim>(G, lame) * sample.basis->measure();
      EXPECT_NEAR(energy_of<Dim>(energy, gradient_field<Dim>(*sample.basis, G)), expected,
                  1e-10 * expected)
          << sample.name << ", nu " << nu;
    }
  }
}

template <int Dim>
void expect_exact_hessian() {
  const auto basis = testing::tensor_over<Dim>(test_box<Dim>(), 3, 2);
  const LinearElasticEnergy<Dim> energy(*basis, {.plane = PlaneState::kStrain, .tissue = {2, 0.3}});
  const auto phi = testing::Numbers(3).columns<Dim>(basis->num_control_points());
  EXPECT_LT(testing::hessian_error<Dim>(energy, *basis, phi, 1e-2), 1e-10);
  testing::expect_scaled<Dim>(energy, *basis, phi);
  const auto dense = testing::dense_hessian<Dim>(energy, *basis, phi);
  EXPECT_GT(testing::smallest_eigenvalue(dense), -1e-12 * dense.norm());
  const Eigen::MatrixXd matrix = energy.matrix();
  const Eigen::MatrixXd lower = dense.template triangularView<Eigen::Lower>();
  EXPECT_LT((matrix - lower).norm(), 1e-14 * dense.norm());
}

}  // namespace

TEST(LinearElasticEnergy, OfConstantStrains) {
  expect_constant_strains<2>();
  expect_constant_strains<3>();
}

TEST(LinearElasticEnergy, IsZeroForShiftsAndSmallRotations) {
  const auto basis = testing::creased_over(test_box<2>(), 2);
  const LinearElasticEnergy<2> energy(*basis, {.tissue = {1000, 0.495}});
  Matrix<2> turn;
  turn << 0, -0.2, 0.2, 0;
  const auto phi = gradient_field<2>(*basis, turn);
  EXPECT_LT(energy_of<2>(energy, phi), 1e-13 * 1000);
  ControlPoints<2> force = ControlPoints<2>::Zero(2, phi.cols());
  energy.evaluate(phi, 1, &force, nullptr);
  EXPECT_LT(force.cwiseAbs().maxCoeff(), 1e-12 * 1000);
}

TEST(LinearElasticEnergy, HessianIsExact) {
  expect_exact_hessian<2>();
  expect_exact_hessian<3>();
}

// Ten times stiffer in a body: the energy of a constant strain is the sum over the regions' areas.
TEST(LinearElasticEnergy, KnowsTheMaterialOfEachRegion) {
  const auto box = test_box<2>();
  const DomainMesh domain = testing::round_body_over(box);
  const TriangularBSplineBasis<2> basis(place_knots(domain, {.degree = 2}).net);
  double body = 0;
  for (std::size_t t = 0; t < domain.mesh.simplices.size(); ++t) {
    if (domain.mesh.regions[t] > 0) {
      body += signed_content<2>(simplex_corners(domain.mesh, static_cast<int>(t))) / 2;
    }
  }
  ElasticMaterial material{.tissue = {1, 0.3}};
  material.regions[1] = {10, 0.3};
  const Matrix<2> G = Vector<2>(0.3, -0.1).asDiagonal();
  const double soft = density<2>(G, lame_parameters(material.tissue, PlaneState::kStress));
  const double energy =
      energy_of<2>(LinearElasticEnergy<2>(basis, material), gradient_field<2>(basis, G));
  EXPECT_NEAR(energy, soft * (basis.measure() + 9 * body), 1e-10 * energy);
}

TEST(LinearElasticEnergy, RefusesOtherBases) {
  const auto basis = testing::tensor_over<2>(test_box<2>(), 3, 2);
  const auto other = testing::tensor_over<2>(test_box<2>(), 5, 2);
  const LinearElasticEnergy<2> energy(*basis, {});
  EXPECT_THROW(energy.evaluate(ControlPoints<2>::Zero(2, 3), 1, nullptr, nullptr), InvalidInput);
  BlockHessian<2> hessian(other->pattern());
  const ControlPoints<2> phi = ControlPoints<2>::Zero(2, basis->num_control_points());
  EXPECT_THROW(energy.evaluate(phi, 1, nullptr, &hessian), InvalidInput);
  EXPECT_THROW(LinearElasticEnergy<2>(*basis, {.tissue = {-1, 0.3}}), InvalidInput);
}

TEST(LinearElasticEnergy, SameBytesOnAnyNumberOfThreads) {
  const auto basis = testing::creased_over(test_box<2>(), 2);
  set_num_threads(1);
  const Eigen::VectorXd one = LinearElasticEnergy<2>(*basis, {}).matrix().coeffs();
  set_num_threads(4);
  const Eigen::VectorXd four = LinearElasticEnergy<2>(*basis, {}).matrix().coeffs();
  set_num_threads(0);
  EXPECT_EQ(one, four);
}

}  // namespace crease

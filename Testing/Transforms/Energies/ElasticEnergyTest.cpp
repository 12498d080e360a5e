#include "Transforms/Energies/ElasticEnergy.h"

#include <gmock/gmock.h>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Testing/Transforms/Energies/EnergyChecks.h"
#include "Testing/Transforms/SampleBases.h"
#include "Transforms/RigidTransform.h"

namespace crease {
namespace {

using testing::box_basis;
using ::testing::HasSubstr;
using testing::small_basis;
using ::testing::ThrowsMessage;

struct Variant {
  std::string name;
  ElasticMaterial material;
};

/// Both laws, both plane states, with and without mean dilatation.
std::vector<Variant> variants() {
  std::vector<Variant> all;
  for (const auto law : {ElasticLaw::kStVenantKirchhoff, ElasticLaw::kNeoHookean}) {
    for (const auto plane : {PlaneState::kStress, PlaneState::kStrain}) {
      for (const bool mean : {false, true}) {
        ElasticMaterial material;
        material.law = law;
        material.plane = plane;
        material.mean_dilatation = mean;
        material.tissue = {.young = 2, .poisson = 0.4};
        all.push_back({message(law == ElasticLaw::kNeoHookean ? "neo-Hookean" : "St. Venant",
                               plane == PlaneState::kStrain ? ", plane strain" : ", plane stress",
                               mean ? ", mean dilatation" : ""),
                       material});
      }
    }
  }
  return all;
}

Box<2> some_box() { return testing::box(-1, -1, 5, 5); }

std::vector<testing::SampleBasis<2>> plane_bases() {
  std::vector<testing::SampleBasis<2>> bases;
  for (int degree : {1, 2, 3}) {
    bases.push_back({message("triangles of degree ", degree),
                     testing::triangles_over(some_box(), {.degree = degree}, 2)});
    bases.push_back({message("creased triangles of degree ", degree),
                     testing::creased_over(some_box(), degree)});
  }
  bases.push_back({"collapsed triangles",
                   testing::triangles_over(some_box(), {.degree = 2, .collapse_all = true}, 2)});
  bases.push_back({"Powell-Sabin",
                   std::make_shared<PowellSabinBasis>(structured_triangulation(some_box(), 2, 2))});
  bases.push_back({"tensor", testing::tensor_over<2>(some_box(), 3, 2)});
  return bases;
}

/// Moderate deformations: no point folds, so that neo-Hookean energies are finite.
template <int Dim>
ControlPoints<Dim> small_motion(const SplineBasis<Dim>& basis, double size = 0.08) {
  return testing::Numbers(8).columns<Dim>(basis.num_control_points(), size);
}

template <int Dim>
AffineMap<Dim> some_rigid_map() {
  RigidTransform<Dim> rigid(Point<Dim>::Constant(2));
  const Eigen::VectorXd p = Eigen::VectorXd::LinSpaced(rigid.num_parameters(), 0.7, 2.3);
  rigid.set_parameters(p);
  return rigid.affine_map();
}

/// K dphi against central differences of R, relative.
template <int Dim>
double tangent_error(const ElasticEnergy<Dim>& energy, const ControlPoints<Dim>& phi, double step) {
  BlockHessian<Dim> hessian(energy.pattern());
  energy.evaluate(phi, 1, nullptr, &hessian, ElasticTangent::kExact, nullptr);
  const Eigen::SparseMatrix<double> lower = hessian.to_sparse();
  const ControlPoints<Dim> direction = testing::Numbers(6).columns<Dim>(phi.cols());
  ControlPoints<Dim> plus = 0 * phi, minus = plus;
  energy.evaluate(phi + step * direction, 1, &plus, nullptr);
  energy.evaluate(phi - step * direction, 1, &minus, nullptr);
  const Eigen::VectorXd expected = ((plus - minus) / (2 * step)).reshaped();
  const Eigen::VectorXd found =
      lower.selfadjointView<Eigen::Lower>() * Eigen::VectorXd(direction.reshaped());
  return (found - expected).norm() / expected.norm();
}

template <int Dim>
void expect_derivatives(const SplineBasis<Dim>& basis, const ElasticMaterial& material,
                        const std::string& what) {
  AffineMap<Dim> affine;
  affine.linear = testing::turned<Dim>(0.4);
  affine.linear(0, 1) += 0.1;
  const ElasticEnergy<Dim> energy(basis, material, affine);
  const ControlPoints<Dim> phi = small_motion<Dim>(basis);
  LeastDeterminant<Dim> least;
  ASSERT_TRUE(
      std::isfinite(energy.evaluate(phi, 1, nullptr, nullptr, ElasticTangent::kExact, &least)))
      << what << ", det " << least.value;
  testing::expect_gradient<Dim>(energy, phi, what);
  const double coarse = tangent_error<Dim>(energy, phi, 1e-4);
  EXPECT_LT(tangent_error<Dim>(energy, phi, 1e-5), std::max(1e-8, coarse / 90)) << what;
  EXPECT_LT(tangent_error<Dim>(energy, phi, 1e-5), 1e-6) << what;
}

}  // namespace

TEST(ElasticEnergy, DerivativesMatchCentralDifferencesInThePlane) {
  for (const auto& sample : plane_bases()) {
    for (const auto& variant : variants()) {
      expect_derivatives<2>(*sample.basis, variant.material, sample.name + ", " + variant.name);
    }
  }
}

TEST(ElasticEnergy, DerivativesMatchCentralDifferencesInSpace) {
  const auto basis = box_basis<3>(2, 4.0, 2);
  for (const auto& variant : variants()) {
    if (variant.material.plane == PlaneState::kStress) continue;
    expect_derivatives<3>(*basis, variant.material, variant.name);
  }
}

TEST(ElasticEnergy, VanishesWithItsForcesForRigidMotions) {
  for (const auto& sample : plane_bases()) {
    for (const auto& variant : variants()) {
      const ElasticEnergy<2> energy(*sample.basis, variant.material);
      const auto phi = testing::affine_control_points<2>(*sample.basis, some_rigid_map<2>());
      ControlPoints<2> forces = 0 * phi;
      const double stored = energy.evaluate(phi, 1, &forces, nullptr);
      const double unit = energy.largest_stiffness();
      EXPECT_LT(std::abs(stored), 1e-13 * unit * energy.measure()) << sample.name << variant.name;
      EXPECT_LT(forces.cwiseAbs().maxCoeff(), 1e-13 * unit * std::sqrt(energy.measure()))
          << sample.name << ", " << variant.name;
    }
  }
}

// S_11 = (lambda + 2 mu) (s^2 - 1) / 2 where the sides are held.
TEST(ElasticEnergy, OfAStretchIsKnown) {
  const auto basis = testing::triangles_over(some_box(), {.degree = 2});
  ElasticMaterial material;
  material.tissue = {.young = 3, .poisson = 0.45};
  for (const auto plane : {PlaneState::kStress, PlaneState::kStrain}) {
    material.plane = plane;
    const auto [lambda, mu] = lame_parameters(material.tissue, plane);
    const ElasticEnergy<2> energy(*basis, material);
    for (const double s : {0.7, 1.3, 2.0}) {
      AffineMap<2> stretch;
      stretch.linear(0, 0) = s;
      const auto phi = testing::affine_control_points<2>(*basis, stretch);
      const ControlPoints<2> wider = basis->greville_points().row(0).replicate(2, 1).eval();
      ControlPoints<2> forces = 0 * phi, virtual_stretch = 0 * phi;
      virtual_stretch.row(0) = wider.row(0);
      const double stored = energy.evaluate(phi, 1, &forces, nullptr);
      const double E = 0.5 * (s * s - 1), S = (lambda + 2 * mu) * E, area = 36;
      EXPECT_NEAR(stored, 0.5 * S * E * area, 1e-12 * std::abs(stored));
      // dW/ds = P_11 area = s S_11 area
      EXPECT_NEAR(forces.cwiseProduct(virtual_stretch).sum(), s * S * area,
                  1e-12 * std::abs(s * S * area));
    }
  }
}

TEST(ElasticEnergy, AtRestItIsLinearElasticity) {
  const auto basis = testing::triangles_over(some_box(), {.degree = 2});
  ElasticMaterial material;
  material.tissue = {.young = 1, .poisson = 0.3};
  const auto [lambda, mu] = lame_parameters(material.tissue, material.plane);
  const ElasticEnergy<2> energy(*basis, material);
  const ControlPoints<2> u = small_motion<2>(*basis, 1);
  const auto hessian = testing::dense_hessian<2>(energy, *basis, 0 * u);
  double expected = 0;  // int lambda tr(eps)^2 + 2 mu |eps|^2
  for (const auto& element : basis->quadrature(basis->product_degree(2, 1), 1)) {
    for (Eigen::Index p = 0; p < element.weights.size(); ++p) {
      Matrix<2> gradient = Matrix<2>::Zero();
      for (std::size_t i = 0; i < element.control_points.size(); ++i) {
        for (int s = 0; s < 2; ++s) {
          gradient.col(s) += u.col(element.control_points[i]) * element.gradients[s](i, p);
        }
      }
      const Matrix<2> strain = 0.5 * (gradient + gradient.transpose());
      expected += element.weights[p] *
                  (lambda * std::pow(strain.trace(), 2) + 2 * mu * strain.squaredNorm());
    }
  }
  const Eigen::VectorXd x = u.reshaped();
  EXPECT_NEAR(x.dot(hessian * x), expected, 1e-12 * expected);
}

// Compressed beyond its limit St. Venant-Kirchhoff tissue is unstable; the semi-definite part is not.
TEST(ElasticEnergy, SemidefiniteTangentIsSo) {
  for (const auto& variant : variants()) {
    const auto basis = testing::triangles_over(some_box(), {.degree = 2}, 2);
    const ElasticEnergy<2> energy(*basis, variant.material);
    AffineMap<2> squeeze;
    squeeze.linear *= 0.5;
    const ControlPoints<2> phi =
        testing::affine_control_points<2>(*basis, squeeze) + small_motion<2>(*basis, 0.05);
    const auto smallest = [&](ElasticTangent tangent) {
      BlockHessian<2> hessian(energy.pattern());
      energy.evaluate(phi, 1, nullptr, &hessian, tangent, nullptr);
      const Eigen::MatrixXd lower = hessian.to_sparse();
      const Eigen::MatrixXd full = lower.selfadjointView<Eigen::Lower>();
      return testing::smallest_eigenvalue(full) / energy.largest_stiffness();
    };
    EXPECT_LT(smallest(ElasticTangent::kExact), -1e-4) << variant.name;
    EXPECT_GT(smallest(ElasticTangent::kSemidefinite), -1e-12) << variant.name;
  }
}

TEST(ElasticEnergy, SemidefiniteTangentIsExactWhereThatIsSafe) {
  const auto basis = testing::triangles_over(some_box(), {.degree = 2});
  for (const auto& variant : variants()) {
    if (variant.material.mean_dilatation) continue;
    const ElasticEnergy<2> energy(*basis, variant.material);
    AffineMap<2> stretch;
    stretch.linear << 1.3, 0.05, 0, 1.2;
    const auto phi = testing::affine_control_points<2>(*basis, stretch);
    EXPECT_LT(testing::hessian_error<2>(energy, *basis, phi), 1e-6) << variant.name;
    testing::expect_scaled<2>(energy, *basis, phi);
  }
}

TEST(ElasticEnergy, IsInfiniteWhereNeoHookeanTissueFolds) {
  const auto basis = testing::triangles_over(some_box(), {.degree = 2});
  AffineMap<2> mirror;
  mirror.linear(0, 0) = -1;
  const auto phi = testing::affine_control_points<2>(*basis, mirror);
  ElasticMaterial material;
  material.law = ElasticLaw::kNeoHookean;
  for (const bool mean : {false, true}) {
    material.mean_dilatation = mean;
    LeastDeterminant<2> least;
    EXPECT_EQ(ElasticEnergy<2>(*basis, material)
                  .evaluate(phi, 1, nullptr, nullptr, ElasticTangent::kExact, &least),
              std::numeric_limits<double>::infinity());
    EXPECT_NEAR(least.value, -1, 1e-12);
  }
}

TEST(ElasticEnergy, FindsTheLeastDeterminant) {
  const auto basis = testing::triangles_over(some_box(), {.degree = 2});
  const ElasticEnergy<2> energy(*basis);
  const ControlPoints<2> phi = small_motion<2>(*basis, 0.3);
  LeastDeterminant<2> least;
  energy.evaluate(phi, 1, nullptr, nullptr, ElasticTangent::kExact, &least);
  SplineTransform<2> transform(basis);
  transform.set_control_points(phi);
  EXPECT_NEAR(transform.spatial_jacobian(least.place).determinant(), least.value, 1e-10);
  testing::Numbers numbers(3);
  for (int n = 0; n < 200; ++n) {
    const Point<2> x(2 + 2.9 * numbers(), 2 + 2.9 * numbers());
    EXPECT_GT(transform.spatial_jacobian(x).determinant(), least.value - 0.2);
  }
}

TEST(ElasticEnergy, ChoosesMaterialByRegionOrPoint) {
  DomainMesh domain = testing::round_body_over(some_box());
  const auto basis =
      std::make_shared<TriangularBSplineBasis<2>>(place_knots(domain, {.degree = 2}).net);
  AffineMap<2> stretch;
  stretch.linear(1, 1) = 1.2;
  const auto phi = testing::affine_control_points<2>(*basis, stretch);
  const double body = testing::region_area(domain.mesh, 1) / 36;
  const double soft = ElasticEnergy<2>(*basis).evaluate(phi, 1, nullptr, nullptr);
  ElasticMaterial material;
  material.regions[1] = {.young = 10, .poisson = 0.495};
  EXPECT_NEAR(ElasticEnergy<2>(*basis, material).evaluate(phi, 1, nullptr, nullptr),
              soft * (1 + 9 * body), 1e-10 * soft);

  const auto lattice = testing::tensor_over<2>(some_box(), 6, 2);
  ElasticOptions<2> options;
  options.region_at = [](const Point<2>& x) { return x.x() < 2 ? 1 : 0; };
  const auto on_lattice = testing::affine_control_points<2>(*lattice, stretch);
  EXPECT_NEAR(
      ElasticEnergy<2>(*lattice, material, {}, options).evaluate(on_lattice, 1, nullptr, nullptr),
      soft * 5.5, 1e-10 * soft);
}

// The stand-in agrees with the energy to second order for a dilatation plus a rotation, on average.
TEST(ElasticEnergy, StandInPullsTowardsRotations) {
  const auto basis = testing::triangles_over(some_box(), {.degree = 2}, 2);
  const ElasticEnergy<2> energy(*basis);
  const HessianPattern& pattern = *basis->pattern();
  std::vector<double> stiffness(pattern.num_entries(), 0.0);
  energy.add_stiffness(1, pattern, stiffness);
  const auto phi = testing::affine_control_points<2>(*basis, some_rigid_map<2>());
  ControlPoints<2> pull = 0 * phi;
  EXPECT_TRUE(energy.add_pull(phi, 1, pull));
  ControlPoints<2> product = 0 * phi;  // K phi = b: rigid motions are its minimum
  for (int i = 0; i < pattern.size(); ++i) {
    for (int s = pattern.row_start()[i]; s < pattern.row_start()[i + 1]; ++s) {
      const int k = pattern.columns()[s];
      product.col(i) += stiffness[s] * phi.col(k);
      if (k != i) product.col(k) += stiffness[s] * phi.col(i);
    }
  }
  EXPECT_LT((product - pull).norm(), 1e-11 * pull.norm());
}

TEST(ElasticEnergy, SameBytesOnAnyNumberOfThreads) {
  const auto basis = testing::creased_over(some_box(), 2);
  const ElasticEnergy<2> energy(*basis);
  const ControlPoints<2> phi = small_motion<2>(*basis, 0.3);
  const auto run = [&] {
    ControlPoints<2> gradient = 0 * phi;
    BlockHessian<2> hessian(energy.pattern());
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

TEST(ElasticEnergy, RefusesBadInput) {
  const auto basis = testing::triangles_over(some_box(), {.degree = 2}, 2);
  ElasticMaterial material;
  material.regions[3] = {.young = 5};
  EXPECT_THAT(
      [&] { ElasticEnergy<2>(*basis, material); },
      ThrowsMessage<InvalidInput>(HasSubstr("names region 3, but the domain has the regions 0")));
  EXPECT_THAT([&] { ElasticEnergy<2>(*small_basis<2>(), material); },
              ThrowsMessage<InvalidInput>(HasSubstr("the domain has no regions")));
  material.regions.clear();
  material.tissue.poisson = 0.6;
  EXPECT_THROW(ElasticEnergy<2>(*basis, material), InvalidInput);
  const ElasticEnergy<2> energy(*basis);
  EXPECT_THROW(energy.evaluate(ControlPoints<2>::Zero(2, 3), 1, nullptr, nullptr), InvalidInput);
}

}  // namespace crease

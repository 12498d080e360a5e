#include "Transforms/Energies/ElasticMaterial.h"

#include <gmock/gmock.h>

#include "Core/Error.h"
#include "Testing/Gradients.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Energies/StoredEnergy.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

template <int Dim>
Matrix<Dim> some_gradient(unsigned seed) {
  return Matrix<Dim>::Identity() + testing::Numbers(seed).columns<Dim>(Dim, 0.3);
}

ElasticMaterial with_law(ElasticLaw law) {
  ElasticMaterial material;
  material.law = law;
  material.tissue = {.young = 2, .poisson = 0.4};
  return material;
}

/// P = F S = dW/dF, entry by entry.
template <int Dim>
void expect_stress_is_slope_of_energy(const ElasticMaterial& material) {
  const Matrix<Dim> F = some_gradient<Dim>(3), direction = some_gradient<Dim>(9);
  const auto state = elastic_state<Dim>(material, 0, F);
  testing::expect_slope(
      [&](double t) {
        return elastic_state<Dim>(material, 0, Matrix<Dim>(F + t * direction)).energy;
      },
      (F * state.piola_stress).cwiseProduct(direction).sum(), "stored energy");
}

}  // namespace

TEST(ElasticMaterial, HasTheLameParametersOfItsState) {
  const ElasticTissue breast{.young = 1000, .poisson = 0.495};
  const auto strain = lame_parameters(breast, PlaneState::kStrain);
  const auto stress = lame_parameters(breast, PlaneState::kStress);
  EXPECT_NEAR(strain.mu, 1000 / (2 * 1.495), 1e-10);
  EXPECT_EQ(strain.mu, stress.mu);
  EXPECT_NEAR(strain.lambda, 33110.4, 0.1);
  EXPECT_NEAR(stress.lambda, 655.7, 0.1);
  EXPECT_NEAR(stress.lambda, 2 * strain.lambda * strain.mu / (strain.lambda + 2 * strain.mu), 1e-9);
}

// In plane stress a bar pulled along one axis has E as stiffness and thins by nu, as in space.
TEST(ElasticMaterial, PlaneStressKeepsYoungsModulusAndPoissonsRatio) {
  ElasticMaterial material;
  material.tissue = {.young = 3, .poisson = 0.3};
  const double strain = 1e-6;
  Matrix<2> F = Matrix<2>::Identity();
  F(0, 0) += strain;
  F(1, 1) -= 0.3 * strain;
  const auto state = elastic_state<2>(material, 0, F);
  EXPECT_NEAR(state.cauchy_stress(0, 0), 3 * strain, 1e-5 * strain);
  EXPECT_NEAR(state.cauchy_stress(1, 1), 0, 1e-5 * strain);
}

TEST(ElasticMaterial, StressIsTheSlopeOfTheStoredEnergy) {
  for (const auto law : {ElasticLaw::kStVenantKirchhoff, ElasticLaw::kNeoHookean}) {
    expect_stress_is_slope_of_energy<2>(with_law(law));
    expect_stress_is_slope_of_energy<3>(with_law(law));
  }
}

// St. Venant-Kirchhoff: S_11 = (lambda + 2 mu) (s^2 - 1) / 2 and S_22 = lambda (s^2 - 1) / 2.
TEST(ElasticMaterial, StressOfALaterallyHeldStretchIsKnown) {
  ElasticMaterial material;
  material.tissue = {.young = 3, .poisson = 0.45};
  for (const auto plane : {PlaneState::kStress, PlaneState::kStrain}) {
    material.plane = plane;
    const auto [lambda, mu] = lame_parameters(material.tissue, plane);
    for (const double s : {0.6, 0.9, 1.3, 2.0}) {
      Matrix<2> F = Matrix<2>::Identity();
      F(0, 0) = s;
      const auto stress = elastic_state<2>(material, 0, F).piola_stress;
      const double strain = (s * s - 1) / 2, unit = (lambda + 2 * mu) * std::abs(strain);
      EXPECT_NEAR(stress(0, 0), (lambda + 2 * mu) * strain, 1e-12 * unit);
      EXPECT_NEAR(stress(1, 1), lambda * strain, 1e-12 * unit);
      EXPECT_NEAR(stress(0, 1), 0, 1e-12 * unit);
    }
  }
}

TEST(ElasticMaterial, LawsAgreeForSmallStrains) {
  const double small = 1e-5;
  const Matrix<3> F = Matrix<3>::Identity() + small * testing::Numbers(5).columns<3>(3);
  const auto linear = elastic_state<3>(with_law(ElasticLaw::kStVenantKirchhoff), 0, F);
  const auto other = elastic_state<3>(with_law(ElasticLaw::kNeoHookean), 0, F);
  EXPECT_NEAR(other.energy, linear.energy, 100 * small * linear.energy);
  EXPECT_LT((other.cauchy_stress - linear.cauchy_stress).norm(),
            100 * small * linear.cauchy_stress.norm());
}

TEST(ElasticMaterial, RotationsCauseNoStress) {
  for (const auto law : {ElasticLaw::kStVenantKirchhoff, ElasticLaw::kNeoHookean}) {
    const auto state = elastic_state<2>(with_law(law), 0, testing::turned<2>(0.7));
    EXPECT_NEAR(state.energy, 0, 1e-15);
    EXPECT_LT(state.cauchy_stress.norm(), 1e-14);
    EXPECT_NEAR(state.determinant, 1, 1e-15);
  }
}

TEST(ElasticMaterial, ChoosesTissueByRegion) {
  ElasticMaterial material;
  material.regions[2] = {.young = 10, .poisson = 0.1};
  EXPECT_EQ(material.of(2).young, 10);
  EXPECT_EQ(material.of(0).young, 1);
}

TEST(ElasticMaterial, RefusesBadParameters) {
  const auto refused = [](ElasticTissue tissue, PlaneState plane, const char* text) {
    EXPECT_THAT([&] { lame_parameters(tissue, plane); },
                ThrowsMessage<InvalidInput>(HasSubstr(text)));
  };
  refused({.young = 0, .poisson = 0.3}, PlaneState::kStress, "E = 0");
  refused({.young = -5, .poisson = 0.3}, PlaneState::kStress, "E = -5");
  refused({.young = std::nan(""), .poisson = 0.3}, PlaneState::kStress, "E = nan");
  refused({.young = 1, .poisson = 0.5}, PlaneState::kStress, "(-1, 0.5)");
  refused({.young = 1, .poisson = -1}, PlaneState::kStress, "(-1, 0.5)");
  refused({.young = 1, .poisson = 0.4995}, PlaneState::kStrain, "plane strain");
  EXPECT_NO_THROW(lame_parameters({.young = 1, .poisson = 0.4995}, PlaneState::kStress));
  ElasticMaterial material;
  material.regions[7] = {.young = 1, .poisson = 0.7};
  EXPECT_THAT([&] { check_material(material); },
              ThrowsMessage<InvalidInput>(HasSubstr("region 7")));
}

}  // namespace crease

// Gradients of all energies on all bases, in the plane and in space.
#include "Testing/Gradients.h"
#include "Testing/Transforms/Energies/EnergyChecks.h"
#include "Testing/Transforms/SampleBases.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/Energies/DirichletEnergy.h"
#include "Transforms/Energies/FoldingEnergy.h"
#include "Transforms/Energies/LandmarkEnergy.h"
#include "Transforms/Energies/LinearElasticEnergy.h"
#include "Transforms/Energies/RigidityEnergy.h"

namespace crease {
namespace {

template <int Dim>
std::vector<std::pair<std::string, std::shared_ptr<const Energy<Dim>>>> energies_on(
    const testing::SampleBasis<Dim>& sample, const Box<Dim>& box) {
  const SplineBasis<Dim>& basis = *sample.basis;
  AffineMap<Dim> affine;  // part of the map whose strain counts
  affine.linear = testing::turned<Dim>(0.7);
  affine.linear(0, 1) += 0.3;
  testing::Numbers numbers(5);
  std::vector<Point<Dim>> fixed, moving;
  for (int j = 0; j < 5; ++j) {
    const Vector<Dim> share = numbers.columns<Dim>(1, 0.45).array() + 0.5;
    fixed.push_back(box.lower + share.cwiseProduct(box.size()));
    moving.push_back(fixed.back() + numbers.columns<Dim>(1));
  }
  const std::vector<double> sigma = {0.5, 1, 2, 1, 0.7};
  std::vector<std::pair<std::string, std::shared_ptr<const Energy<Dim>>>> energies = {
      {"landmarks", std::make_shared<LandmarkEnergy<Dim>>(basis, affine, fixed, moving, sigma)}};
  if (!sample.integrates) return energies;
  const WeightField<Dim> weights = [](const Point<Dim>& x, int) {
    return 0.5 + 0.4 * std::sin(x[0] - x[1]);
  };
  energies.emplace_back("bending", std::make_shared<BendingEnergy<Dim>>(basis, weights));
  energies.emplace_back("stretching", std::make_shared<DirichletEnergy<Dim>>(basis));
  energies.emplace_back("rigidity", std::make_shared<RigidityEnergy<Dim>>(basis, weights, affine));
  energies.emplace_back("linear elasticity", std::make_shared<LinearElasticEnergy<Dim>>(
                                                 basis, ElasticMaterial{.tissue = {2, 0.4}}));
  energies.emplace_back("folding", std::make_shared<FoldingEnergy<Dim>>(
                                       basis, affine, FoldingOptions{.threshold = 0.9}));
  return energies;
}

template <int Dim>
void expect_gradients() {
  Box<Dim> box;
  box.add(Point<Dim>::Constant(-1));
  box.add(Point<Dim>::Constant(5));
  for (const auto& sample : testing::sample_bases<Dim>(box)) {
    const ControlPoints<Dim> phi =
        testing::Numbers(8).columns<Dim>(sample.basis->num_control_points(), 0.4);
    for (const auto& [name, energy] : energies_on<Dim>(sample, box)) {
      testing::expect_gradient<Dim>(*energy, phi, sample.name + ", " + name);
    }
  }
}

}  // namespace

TEST(EnergyDerivatives, GradientsMatchCentralDifferencesInThePlane) { expect_gradients<2>(); }
TEST(EnergyDerivatives, GradientsMatchCentralDifferencesInSpace) { expect_gradients<3>(); }

}  // namespace crease

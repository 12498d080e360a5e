#include "Transforms/Energies/LandmarkEnergy.h"

#include <gmock/gmock.h>

#include "Core/Error.h"
#include "Testing/Transforms/Energies/EnergyChecks.h"

namespace crease {
namespace {

template <int Dim>
void check_value_and_derivatives() {
  const auto basis = testing::small_basis<Dim>();
  const auto fixed = testing::points_inside<Dim>(basis->lattice(), 6);
  testing::Numbers numbers;
  std::vector<Point<Dim>> moving;
  std::vector<double> sigma;
  for (const auto& p : fixed) {
    moving.push_back(p + numbers.columns<Dim>(1));
    sigma.push_back(1.5 + numbers());
  }
  AffineMap<Dim> affine;
  affine.offset.setConstant(0.5);
  const LandmarkEnergy<Dim> energy(*basis, affine, fixed, moving, sigma);
  const ControlPoints<Dim> phi = numbers.columns<Dim>(basis->num_control_points());

  SplineTransform<Dim> transform(basis, affine);
  transform.set_control_points(phi);
  double expected = 0;
  for (std::size_t j = 0; j < fixed.size(); ++j) {
    expected += 0.5 * (transform.map(fixed[j]) - moving[j]).squaredNorm() / (sigma[j] * sigma[j]);
  }
  EXPECT_NEAR(energy.evaluate(phi, 1, nullptr, nullptr), expected, 1e-12 * expected);
  EXPECT_LT(testing::hessian_error<Dim>(energy, *basis, phi, 1e-2), 1e-8);
  testing::expect_scaled<Dim>(energy, *basis, phi);
}

}  // namespace

TEST(LandmarkEnergy, IsTheWeightedSquareOfTheDistances) {
  check_value_and_derivatives<2>();
  check_value_and_derivatives<3>();
}

TEST(LandmarkEnergy, NamesTheLandmarkAtFault) {
  const auto basis = testing::box_basis<2>(4, 4.0);
  const std::vector<Point<2>> fixed = {{1, 1}, {7, 1}}, inside = {{1, 1}, {2, 1}};
  const std::vector<double> sigma = {1, 1}, zero = {1, 0};
  EXPECT_THAT([&] { LandmarkEnergy<2>(*basis, {}, fixed, inside, sigma); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::AllOf(
                  ::testing::HasSubstr("landmark 1"), ::testing::HasSubstr("3 mm outside"))));
  EXPECT_THROW(LandmarkEnergy<2>(*basis, {}, inside, inside, zero), InvalidInput);
  EXPECT_THROW(LandmarkEnergy<2>(*basis, {}, inside, {}, sigma), InvalidInput);
}

}  // namespace crease

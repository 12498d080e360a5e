#include "Transforms/Energies/ElasticQuadrature.h"

#include <gmock/gmock.h>

#include "Core/Error.h"
#include "Testing/Transforms/SampleBases.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Energies/ElasticEnergy.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Box<2> some_box() { return testing::box(-1, -1, 5, 5); }

ElasticEnergy<2> energy_by(ElasticQuadrature quadrature, const SplineBasis<2>& basis,
                           const ElasticMaterial& material = {}) {
  return ElasticEnergy<2>(basis, material, {}, {.quadrature = quadrature});
}

double error_of_cheap(const SplineBasis<2>& basis, const ElasticMaterial& material = {}) {
  return relative_tangent_difference(energy_by(ElasticQuadrature::kCheap, basis, material),
                                     energy_by(ElasticQuadrature::kCells, basis, material));
}

}  // namespace

TEST(ElasticQuadrature, CheapPointsCoverEveryTriangle) {
  const auto basis = testing::creased_over(some_box(), 2);
  const auto elements = cheap_elements(*basis);
  double area = 0;
  for (const auto& element : elements) {
    EXPECT_EQ(element.weights.size(), 12);
    area += element.weights.sum();
    // The functions sum to 1, so that their gradients sum to 0.
    EXPECT_LT((element.values.colwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
    for (const auto& slopes : element.gradients) {
      EXPECT_LT(slopes.colwise().sum().cwiseAbs().maxCoeff(), 1e-10);
    }
  }
  EXPECT_NEAR(area, 36, 1e-12 * 36);
}

// Knots in general position: the knot lines pass between the points.
TEST(ElasticQuadrature, CheapIsOffByLittleWhereTrianglesHaveManyCells) {
  const double error = error_of_cheap(*testing::creased_over(some_box(), 2));
  EXPECT_GT(error, 1e-4);
  EXPECT_LT(error, 0.1);
}

TEST(ElasticQuadrature, CheapIsExactWhereTrianglesAreCells) {
  const auto basis = testing::triangles_over(some_box(), {.degree = 2, .collapse_all = true}, 2);
  ElasticMaterial material;
  EXPECT_LT(error_of_cheap(*basis), 1e-10);
  material.mean_dilatation = true;
  EXPECT_LT(error_of_cheap(*basis, material), 1e-10);
  // Not only at rest: 12 points are exact for the quartic energy of quadratic splines.
  const ControlPoints<2> phi = testing::Numbers(8).columns<2>(basis->num_control_points(), 0.3);
  ControlPoints<2> cheap = 0 * phi, exact = cheap;
  const double energy =
      energy_by(ElasticQuadrature::kCells, *basis).evaluate(phi, 1, &exact, nullptr);
  EXPECT_NEAR(energy_by(ElasticQuadrature::kCheap, *basis).evaluate(phi, 1, &cheap, nullptr),
              energy, 1e-10 * energy);
  EXPECT_LT((cheap - exact).norm(), 1e-10 * exact.norm());
}

TEST(ElasticQuadrature, CheapNeedsTriangles) {
  const auto lattice = testing::tensor_over<2>(some_box(), 4, 2);
  EXPECT_THAT([&] { energy_by(ElasticQuadrature::kCheap, *lattice); },
              ThrowsMessage<InvalidInput>(HasSubstr("no triangles")));
}

}  // namespace crease

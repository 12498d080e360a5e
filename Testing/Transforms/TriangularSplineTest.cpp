// Energies, projection and the generic grid on triangular B-splines: they know no basis in particular.
#include <gtest/gtest.h>

#include "Core/Parallel.h"
#include "Testing/Transforms/Energies/EnergyChecks.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/Energies/RigidityEnergy.h"
#include "Transforms/SparseRowGrid.h"
#include "Transforms/SplineProjection.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

class TriangularSpline : public ::testing::Test {
 protected:
  TriangularBSplineBasis<2> basis{testing::jittered_net(3, 3, 3, 0.3, 3)};
  double area = basis.measure();
};

AffineMap<2> rotation() { return {testing::turned<2>(0.7), Vector<2>(3, -8)}; }

}  // namespace

TEST_F(TriangularSpline, RigidMotionsHaveNoEnergy) {
  const auto phi = testing::affine_control_points<2>(basis, rotation());
  EXPECT_LT(RigidityEnergy<2>(basis, nullptr).evaluate(phi, 1, nullptr, nullptr), 1e-14 * area);
  EXPECT_LT(BendingEnergy<2>(basis).evaluate(phi, 1, nullptr, nullptr), 1e-12);
}

TEST_F(TriangularSpline, StretchHasTheKnownEnergy) {
  AffineMap<2> stretch;
  stretch.linear(0, 0) = 1.4;
  const double expected = area * std::pow(1.4 * 1.4 - 1, 2) / 8;
  const auto phi = testing::affine_control_points<2>(basis, stretch);
  EXPECT_NEAR(RigidityEnergy<2>(basis, nullptr).evaluate(phi, 1, nullptr, nullptr), expected,
              1e-12 * expected);
}

TEST_F(TriangularSpline, ParabolaBendsTwiceTheArea) {
  const auto fit = project<2>(basis, [](const Point<2>& x) { return Vector<2>(x[0] * x[0], 0); });
  EXPECT_LT(fit.max_error, 1e-9);
  EXPECT_NEAR(BendingEnergy<2>(basis).evaluate(fit.control_points, 1, nullptr, nullptr), 2 * area,
              1e-10 * 2 * area);
}

TEST_F(TriangularSpline, ExactHessianMatchesDifferences) {
  const ControlPoints<2> phi = testing::Numbers().columns<2>(basis.num_control_points(), 0.5);
  const auto soft = [](const Point<2>& x, int) { return 0.5 + 0.4 * std::sin(x[0]); };
  const RigidityEnergy<2> rigidity(basis, soft, rotation(), {.exact_hessian = true});
  EXPECT_LT(testing::hessian_error<2>(rigidity, basis, phi), 1e-6);
  testing::expect_scaled<2>(rigidity, basis, phi);
}

TEST_F(TriangularSpline, EnergiesHaveTheSameBytesOnAnyNumberOfThreads) {
  const ControlPoints<2> phi = testing::Numbers().columns<2>(basis.num_control_points(), 0.5);
  const auto run = [&] {
    ControlPoints<2> gradient = 0 * phi;
    BlockHessian<2> hessian(testing::pattern_of<2>(basis));
    RigidityEnergy<2>(basis, nullptr).evaluate(phi, 1, &gradient, &hessian);
    BendingEnergy<2>(basis).evaluate(phi, 1, &gradient, &hessian);
    return std::pair(gradient, Eigen::VectorXd(hessian.to_sparse().coeffs()));
  };
  set_num_threads(1);
  const auto one = run();
  set_num_threads(4);
  const auto four = run();
  set_num_threads(0);
  EXPECT_EQ(one, four);
}

// The basis binds itself by cores and strips; tables of every sample give the same.
TEST_F(TriangularSpline, BoundGridAgreesWithTables) {
  Raster<2> raster;
  raster.size = {61, 47};
  raster.origin = {-1.5, -2.2};
  raster.spacing = {0.55, 0.77};
  const auto own = basis.bind(raster);
  const SparseRowGrid<2> tables(basis, raster);
  const ControlPoints<2> phi = testing::Numbers().columns<2>(basis.num_control_points(), 4);
  const auto of_own = own->prepare(phi), of_tables = tables.prepare(phi);
  for (std::int64_t row = 0; row < raster.num_rows(); ++row) {
    std::array<std::vector<float>, 4> buffers;
    for (auto& b : buffers) b.assign(padded_row_size(raster), 0.0f);
    own->map_row(*of_own, row, {buffers[0].data(), buffers[1].data()});
    tables.map_row(*of_tables, row, {buffers[2].data(), buffers[3].data()});
    ASSERT_EQ(own->row_range(row), tables.row_range(row));
    const auto [begin, end] = own->row_range(row);
    for (int i = begin; i < end; ++i) {
      EXPECT_NEAR(buffers[0][i], buffers[2][i], 1e-5);
      EXPECT_NEAR(buffers[1][i], buffers[3][i], 1e-5);
    }
  }
}

// Bending and two-sided rigidity skip the bands of creases; a crease with a body keeps its rigidity.
TEST(TriangularSplineWithCrease, EnergiesSkipTheBands) {
  for (const bool body : {true, false}) {
    const TriangularBSplineBasis<2> basis(testing::ring_net(3, 0.3, body));
    double banded = 0, two_sided = 0;
    for (const auto& e : basis.quadrature(2, 0)) {
      banded += e.in_band ? e.weights.sum() : 0;
      two_sided += e.in_two_sided_band ? e.weights.sum() : 0;
    }
    EXPECT_GT(banded, 0);
    const auto fit = project<2>(basis, [](const Point<2>& x) { return Vector<2>(x[0] * x[0], 0); });
    EXPECT_NEAR(BendingEnergy<2>(basis).evaluate(fit.control_points, 1, nullptr, nullptr),
                2 * (basis.measure() - banded), 1e-9);
    EXPECT_NEAR(RigidityEnergy<2>(basis, nullptr).weighted_measure(), basis.measure() - two_sided,
                1e-10);
    EXPECT_EQ(two_sided > 0, !body);
  }
}

}  // namespace crease

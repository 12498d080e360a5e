// What tensor B-splines do beside the laws of SplineBasisLawsTest.cpp.
#include "Transforms/Splines/TensorBSplineBasis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <set>

#include "Core/Error.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Energies/ScalarAssembly.h"

namespace crease {
namespace {

using testing::small_basis;

template <int Dim, int Degree>
struct Kind {
  static constexpr int kDim = Dim, kDegree = Degree;
};

}  // namespace

template <typename T>
class TensorBSplineBasisSuite : public ::testing::Test {
 public:
  static constexpr int kDim = T::kDim;
  std::shared_ptr<const TensorBSplineBasis<kDim>> basis = small_basis<kDim>(T::kDegree);
  std::vector<Point<kDim>> points() const {
    auto all = testing::points_inside<kDim>(basis->lattice(), 30, 0.0);
    all.push_back(basis->lattice().origin);  // corner, knots, border
    Vector<kDim> t;
    for (int a = 0; a < kDim; ++a) t[a] = basis->lattice().spans[a];
    all.push_back(basis->lattice().point(t));
    all.push_back(basis->lattice().point(Vector<kDim>::Constant(2)));
    return all;
  }
};

using Kinds = ::testing::Types<Kind<2, 1>, Kind<2, 2>, Kind<2, 3>, Kind<2, 4>, Kind<2, 5>,
                               Kind<3, 1>, Kind<3, 2>, Kind<3, 3>>;
TYPED_TEST_SUITE(TensorBSplineBasisSuite, Kinds);

TYPED_TEST(TensorBSplineBasisSuite, KnotInsertionIsExact) {
  constexpr int kDim = TypeParam::kDim;
  testing::Numbers numbers;
  const auto fine = this->basis->refined();
  const ControlPoints<kDim> coarse_points =
      numbers.columns<kDim>(this->basis->num_control_points());
  const ControlPoints<kDim> fine_points = this->basis->refine_control_points(coarse_points);
  for (const auto& x : this->points()) {
    const auto c = this->basis->evaluate(x), f = fine.evaluate(x);
    const Vector<kDim> expected = coarse_points(Eigen::all, c.control_points) * c.values;
    const Vector<kDim> found = fine_points(Eigen::all, f.control_points) * f.values;
    EXPECT_LT((expected - found).norm(), 1e-13);
  }
  EXPECT_NEAR(fine.measure(), this->basis->measure(), 1e-12);
}

// ---- cases of their own ----

// The spline's space holds every polynomial of its degree; cubic in both coordinates here.
TEST(TensorBSplineBasis, ReproducesCubicPolynomials) {
  const auto basis = small_basis<2>(3, 0.0);
  const auto f = [](const Point<2>& x) {
    return x[0] * x[0] * x[0] - 2 * x[0] * x[1] * x[1] + x[1];
  };
  const auto mass = mass_matrix(*basis);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(basis->num_control_points());
  for (const auto& e : basis->quadrature(6, 0)) {
    for (Eigen::Index q = 0; q < e.weights.size(); ++q) {
      for (std::size_t i = 0; i < e.control_points.size(); ++i) {
        rhs[e.control_points[i]] += e.weights[q] * e.values(i, q) * f(e.points.col(q));
      }
    }
  }
  const Eigen::VectorXd c = Eigen::MatrixXd(mass).ldlt().solve(rhs);
  for (const auto& x : testing::points_inside<2>(basis->lattice(), 20, 0.0)) {
    const auto b = basis->evaluate(x);
    EXPECT_NEAR(c(b.control_points).dot(b.values), f(x), 1e-9);
  }
}

TEST(TensorBSplineBasis, HasTheNetOfItsExperiment) {
  const auto basis = testing::box_basis<2>(22, 8.0);
  EXPECT_EQ(basis->num_control_points(), 25 * 25);
  EXPECT_EQ(basis->bounds().upper, Point<2>(8, 8));
}

TEST(TensorBSplineBasis, CoversARasterExactly) {
  Raster<2> raster;
  raster.size = {100, 50};
  raster.spacing = {0.5, 1.0};
  raster.origin = {7, -3};
  raster.direction = testing::turned<2>();
  const auto lattice = covering_lattice(raster, 6.0);
  EXPECT_EQ(lattice.spans, (std::array<int, 2>{8, 8}));
  EXPECT_DOUBLE_EQ(lattice.spacing[0], 50.0 / 8);
  const TensorBSplineBasis<2> basis(lattice);
  const auto expected = raster.bounds();
  EXPECT_LT((basis.bounds().lower - expected.lower).norm(), 1e-12);
  EXPECT_LT((basis.bounds().upper - expected.upper).norm(), 1e-12);
  EXPECT_THROW(covering_lattice(raster, -1.0), InvalidInput);
}

TEST(TensorBSplineBasis, NamesWhatIsWrong) {
  auto lattice = testing::small_lattice<2>();
  EXPECT_THAT([&] { TensorBSplineBasis<2>(lattice, 6); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("degree is 6")));
  lattice.spans[1] = 0;
  EXPECT_THAT([&] { TensorBSplineBasis<2>{lattice}; },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("axis 1 has 0")));
  lattice = testing::small_lattice<2>();
  lattice.spacing[0] = std::nan("");
  EXPECT_THROW(TensorBSplineBasis<2>{lattice}, InvalidInput);
  lattice = testing::small_lattice<2>();
  lattice.direction(0, 0) = 3;
  EXPECT_THROW(TensorBSplineBasis<2>{lattice}, InvalidInput);
  EXPECT_THROW(small_basis<2>()->evaluate({1000, 0}), InvalidInput);
  EXPECT_THROW(small_basis<2>()->evaluate({std::nan(""), 0}), InvalidInput);
  EXPECT_THROW(small_basis<2>()->refine_control_points(Eigen::MatrixXd::Zero(2, 3)), InvalidInput);
}

}  // namespace crease

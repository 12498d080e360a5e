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

/// Packed position of (a, b) among the second derivatives.
template <int Dim>
int packed(int a, int b) {
  return a * Dim - a * (a - 1) / 2 + (b - a);
}

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

TYPED_TEST(TensorBSplineBasisSuite, SumsToOneAndDerivativesToZero) {
  for (const auto& x : this->points()) {
    const auto b = this->basis->evaluate(x, 2);
    EXPECT_NEAR(b.values.sum(), 1, 1e-14);
    EXPECT_GE(b.values.minCoeff(), 0);
    EXPECT_LT(b.gradients.rowwise().sum().norm(), 1e-13);
    EXPECT_LT(b.hessians.rowwise().sum().norm(), 1e-13);
    EXPECT_TRUE(std::is_sorted(b.control_points.begin(), b.control_points.end()));
  }
}

TYPED_TEST(TensorBSplineBasisSuite, GrevillePointsGiveTheIdentity) {
  constexpr int kDim = TypeParam::kDim;
  const auto greville = this->basis->greville_points();
  for (const auto& x : this->points()) {
    const auto b = this->basis->evaluate(x, 2);
    Point<kDim> sum = Point<kDim>::Zero();
    Matrix<kDim> gradient = Matrix<kDim>::Zero();
    Matrix<kDim, kNumSecondDerivatives<kDim>> second;
    second.setZero();
    for (std::size_t n = 0; n < b.control_points.size(); ++n) {
      sum += b.values[n] * greville.col(b.control_points[n]);
      gradient += greville.col(b.control_points[n]) * b.gradients.col(n).transpose();
      second += greville.col(b.control_points[n]) * b.hessians.col(n).transpose();
    }
    EXPECT_LT((sum - x).norm(), 1e-13);
    EXPECT_LT((gradient - Matrix<kDim>::Identity()).norm(), 1e-13);
    EXPECT_LT(second.norm(), 1e-12);
  }
}

TYPED_TEST(TensorBSplineBasisSuite, DerivativesMatchCentralDifferences) {
  constexpr int kDim = TypeParam::kDim;
  constexpr double kStep = 1e-5;
  for (const auto& x : testing::points_inside<kDim>(this->basis->lattice(), 10)) {
    const auto b = this->basis->evaluate(x, 2);
    for (int a = 0; a < kDim; ++a) {
      Vector<kDim> h = Vector<kDim>::Zero();
      h[a] = kStep;
      const auto plus = this->basis->evaluate(x + h, 1), minus = this->basis->evaluate(x - h, 1);
      ASSERT_EQ(plus.control_points, minus.control_points);  // no knot in between: seed chosen so
      const Eigen::VectorXd first = (plus.values - minus.values) / (2 * kStep);
      EXPECT_LT((b.gradients.row(a).transpose() - first).norm(), 1e-9);
      const Eigen::MatrixXd second = (plus.gradients - minus.gradients) / (2 * kStep);
      for (int c = a; c < kDim; ++c) {
        EXPECT_LT((b.hessians.row(packed<kDim>(a, c)) - second.row(c)).norm(), 1e-8);
      }
    }
  }
}

// Functions overlap in a span, or not at all: the couplings are exactly the pairs that elements hold.
TYPED_TEST(TensorBSplineBasisSuite, CouplingsAreThePairsThatElementsHold) {
  std::set<std::pair<int, int>> expected;
  for (const auto& element : this->basis->quadrature(0, 0)) {
    for (int i : element.control_points) {
      for (int k : element.control_points) {
        if (i <= k) expected.emplace(i, k);
      }
    }
  }
  const auto couplings = this->basis->couplings();
  EXPECT_EQ(std::set(couplings.begin(), couplings.end()), expected);
  EXPECT_EQ(couplings.size(), expected.size());
}

TYPED_TEST(TensorBSplineBasisSuite, QuadratureCoversTheDomainWithTheBasis) {
  constexpr int kDim = TypeParam::kDim;
  double measure = 0;
  int num_elements = 0;
  for (const auto& element : this->basis->quadrature(4, 2)) {
    measure += element.weights.sum();
    EXPECT_EQ(element.patch, num_elements++);
    EXPECT_EQ(element.region, -1);
    const Eigen::Index q = element.weights.size() / 2;
    const auto b = this->basis->evaluate(element.points.col(q), 2);
    EXPECT_EQ(b.control_points, element.control_points);
    EXPECT_LT((b.values - element.values.col(q)).norm(), 1e-13);
    for (int a = 0; a < kDim; ++a) {
      EXPECT_LT((b.gradients.row(a).transpose() - element.gradients[a].col(q)).norm(), 1e-12);
    }
    for (int s = 0; s < kNumSecondDerivatives<kDim>; ++s) {
      EXPECT_LT((b.hessians.row(s).transpose() - element.hessians[s].col(q)).norm(), 1e-12);
    }
  }
  EXPECT_NEAR(measure, this->basis->measure(), 1e-12 * measure);
  double box = 1;
  for (int a = 0; a < kDim; ++a) {
    box *= this->basis->lattice().spans[a] * this->basis->lattice().spacing[a];
  }
  EXPECT_NEAR(measure, box, 1e-12 * box);
}

TYPED_TEST(TensorBSplineBasisSuite, QuadratureChoosesPatches) {
  const auto some = this->basis->quadrature(2, 0, [](int, int patch) { return patch % 3 == 1; });
  EXPECT_FALSE(some.empty());
  for (const auto& element : some) EXPECT_EQ(element.patch % 3, 1);
}

// A rule of higher degree gives the same matrix, and its sum is the domain's measure.
TYPED_TEST(TensorBSplineBasisSuite, MassMatrixIsExact) {
  constexpr int kDim = TypeParam::kDim;
  const auto mass = mass_matrix(*this->basis);
  const auto finer =
      assemble_scalar_matrix<kDim>(*this->basis, 2 * TypeParam::kDegree + 4, 0,
                                   [](const QuadratureElement<kDim>& e, Eigen::MatrixXd& factor) {
                                     factor = e.values * e.weights.cwiseSqrt().asDiagonal();
                                   });
  EXPECT_LT((mass - finer).norm(), 1e-13 * mass.norm());
  EXPECT_NEAR(mass.sum(), this->basis->measure(), 1e-11);
}

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

TYPED_TEST(TensorBSplineBasisSuite, NearestPointIsInTheDomainAndNearest) {
  constexpr int kDim = TypeParam::kDim;
  const auto& lattice = this->basis->lattice();
  Vector<kDim> t = Vector<kDim>::Constant(1.5);
  t[0] = -2;
  const auto x = lattice.point(t);
  EXPECT_FALSE(this->basis->contains(x));
  const auto p = this->basis->nearest_point(x);
  EXPECT_TRUE(this->basis->contains(p));
  EXPECT_NEAR((p - x).norm(), 2 * lattice.spacing[0], 1e-12);
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

// What tensor B-spline, NURBS and T-spline bases obey as members of the family, written once.
#include <gtest/gtest.h>

#include <set>

#include "Testing/Transforms/SampleNurbs.h"
#include "Transforms/Energies/ScalarAssembly.h"

namespace crease {
namespace {

template <int Dim, int Degree>
struct Tensor {
  static constexpr int kDim = Dim;
  static std::shared_ptr<const SplineBasis<Dim>> make() {
    return std::make_shared<TensorBSplineBasis<Dim>>(testing::small_lattice<Dim>(), Degree);
  }
};

template <int Dim, int Degree, bool Rational>
struct Nurbs {
  static constexpr int kDim = Dim;
  static std::shared_ptr<const SplineBasis<Dim>> make() {
    const auto lattice = testing::small_lattice<Dim>();
    return std::make_shared<NurbsBasis<Dim>>(Rational ? testing::rational_net<Dim>(lattice, Degree)
                                                      : testing::nurbs_net<Dim>(lattice, Degree));
  }
};

template <int Degree>
struct TSpline {
  static constexpr int kDim = 2;
  static std::shared_ptr<const SplineBasis<2>> make() {
    return testing::tspline(testing::small_lattice<2>(), Degree);
  }
};

}  // namespace

template <typename T>
class SplineBasisLaws : public ::testing::Test {
 public:
  static constexpr int kDim = T::kDim;
  std::shared_ptr<const SplineBasis<kDim>> basis = T::make();
  TensorLattice<kDim> lattice = testing::small_lattice<kDim>();
  std::vector<Point<kDim>> points() const {
    auto all = testing::points_inside<kDim>(lattice, 40, 0.0);
    all.push_back(lattice.origin);  // corner, knots, border
    Vector<kDim> t;
    for (int a = 0; a < kDim; ++a) t[a] = lattice.spans[a];
    all.push_back(lattice.point(t));
    t[0] = 1.234;
    all.push_back(lattice.point(t));
    return all;
  }
};

using Kinds = ::testing::Types<Tensor<2, 1>, Tensor<2, 2>, Tensor<2, 3>, Tensor<2, 4>, Tensor<2, 5>,
                               Tensor<3, 1>, Tensor<3, 2>, Tensor<3, 3>, Nurbs<2, 1, false>,
                               Nurbs<2, 2, true>, Nurbs<2, 3, false>, Nurbs<2, 3, true>,
                               Nurbs<2, 4, true>, Nurbs<2, 5, true>, Nurbs<3, 2, true>,
                               Nurbs<3, 3, false>, TSpline<1>, TSpline<3>, TSpline<5>>;
TYPED_TEST_SUITE(SplineBasisLaws, Kinds);

TYPED_TEST(SplineBasisLaws, SumsToOneAndDerivativesToZero) {
  for (const auto& x : this->points()) {
    const auto b = this->basis->evaluate(x, 2);
    EXPECT_NEAR(b.values.sum(), 1, 1e-14);
    EXPECT_GE(b.values.minCoeff(), 0);
    EXPECT_LT(b.gradients.rowwise().sum().norm(), 1e-12);
    EXPECT_LT(b.hessians.rowwise().sum().norm(), 1e-10);
    EXPECT_TRUE(std::is_sorted(b.control_points.begin(), b.control_points.end()));
  }
}

TYPED_TEST(SplineBasisLaws, GrevillePointsGiveTheIdentity) {
  constexpr int kDim = TypeParam::kDim;
  const auto greville = this->basis->greville_points();
  for (const auto& x : this->points()) {
    const auto b = this->basis->evaluate(x, 2);
    const ControlPoints<kDim> g = greville(Eigen::all, b.control_points);
    EXPECT_LT((g * b.values - x).norm(), 1e-12);
    EXPECT_LT((g * b.gradients.transpose() - Matrix<kDim>::Identity()).norm(), 1e-11);
    EXPECT_LT((g * b.hessians.transpose()).norm(), 1e-9);
  }
}

TYPED_TEST(SplineBasisLaws, DerivativesMatchCentralDifferences) {
  constexpr int kDim = TypeParam::kDim;
  constexpr double kStep = 1e-5;
  for (const auto& x : testing::points_inside<kDim>(this->lattice, 12, 0.01)) {
    const auto b = this->basis->evaluate(x, 2);
    for (int a = 0; a < kDim; ++a) {
      Vector<kDim> h = Vector<kDim>::Zero();
      h[a] = kStep;
      const auto plus = this->basis->evaluate(x + h, 1), minus = this->basis->evaluate(x - h, 1);
      ASSERT_EQ(plus.control_points, minus.control_points);  // no knot in between: seed chosen so
      const Eigen::VectorXd first = (plus.values - minus.values) / (2 * kStep);
      EXPECT_LT((b.gradients.row(a).transpose() - first).norm(), 1e-7);
      const Eigen::MatrixXd second = (plus.gradients - minus.gradients) / (2 * kStep);
      for (int c = a; c < kDim; ++c) {
        const int packed = a * kDim - a * (a - 1) / 2 + (c - a);
        EXPECT_LT((b.hessians.row(packed) - second.row(c)).norm(), 1e-6);
      }
    }
  }
}

TYPED_TEST(SplineBasisLaws, CouplingsAreThePairsThatElementsHold) {
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

TYPED_TEST(SplineBasisLaws, QuadratureCoversTheDomainWithTheBasis) {
  constexpr int kDim = TypeParam::kDim;
  double measure = 0;
  for (const auto& element : this->basis->quadrature(4, 2)) {
    measure += element.weights.sum();
    EXPECT_GT(element.weights.minCoeff(), 0);
    EXPECT_EQ(element.region, -1);
    const Eigen::Index q = element.weights.size() / 2;
    const auto b = this->basis->evaluate(element.points.col(q), 2);
    EXPECT_EQ(b.control_points, element.control_points);
    EXPECT_LT((b.values - element.values.col(q)).norm(), 1e-13);
    for (int a = 0; a < kDim; ++a) {
      EXPECT_LT((b.gradients.row(a).transpose() - element.gradients[a].col(q)).norm(), 1e-11);
    }
    for (int s = 0; s < kNumSecondDerivatives<kDim>; ++s) {
      EXPECT_LT((b.hessians.row(s).transpose() - element.hessians[s].col(q)).norm(), 1e-9);
    }
  }
  EXPECT_NEAR(measure, this->basis->measure(), 1e-12 * measure);
  double box = 1;
  for (int a = 0; a < kDim; ++a) box *= this->lattice.spans[a] * this->lattice.spacing[a];
  EXPECT_NEAR(measure, box, 1e-12 * box);
}

TYPED_TEST(SplineBasisLaws, QuadratureChoosesPatches) {
  const auto some = this->basis->quadrature(2, 0, [](int, int patch) { return patch % 3 == 1; });
  EXPECT_FALSE(some.empty());
  for (const auto& element : some) EXPECT_EQ(element.patch % 3, 1);
}

// A rule of higher degree gives the same matrix, and its sum is the domain's measure.
TYPED_TEST(SplineBasisLaws, MassMatrixIsExact) {
  constexpr int kDim = TypeParam::kDim;
  const auto mass = mass_matrix(*this->basis);
  const int finer = this->basis->product_degree(2, 0) + 8;
  const auto expected = assemble_scalar_matrix<kDim>(
      *this->basis, finer, 0, [](const QuadratureElement<kDim>& e, Eigen::MatrixXd& factor) {
        factor = e.values * e.weights.cwiseSqrt().asDiagonal();
      });
  EXPECT_LT((mass - expected).norm(), 1e-11 * mass.norm());
  EXPECT_NEAR(mass.sum(), this->basis->measure(), 1e-10);
}

TYPED_TEST(SplineBasisLaws, NearestPointIsInTheDomainAndNearest) {
  constexpr int kDim = TypeParam::kDim;
  Vector<kDim> t = Vector<kDim>::Constant(1.5);
  t[0] = -2;
  const auto x = this->lattice.point(t);
  EXPECT_FALSE(this->basis->contains(x));
  const auto p = this->basis->nearest_point(x);
  EXPECT_TRUE(this->basis->contains(p));
  EXPECT_NEAR((p - x).norm(), 2 * this->lattice.spacing[0], 1e-12);
}

}  // namespace crease

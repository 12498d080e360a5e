#include "Transforms/Splines/ThinPlateBasis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Testing/Transforms/SampleCentres.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/Energies/DirichletEnergy.h"
#include "Transforms/LatticeGrid.h"
#include "Transforms/SparseRowGrid.h"
#include "Transforms/Splines/CoveringCentres.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

template <int Dim>
Box<Dim> box_of(double size, double lower = 0) {
  Box<Dim> box;
  box.add(Point<Dim>::Constant(lower));
  box.add(Point<Dim>::Constant(lower + size));
  return box;
}

template <int Dim>
Raster<Dim> raster_of(int size, double spacing) {
  Raster<Dim> raster;
  raster.size.fill(size);
  raster.spacing.setConstant(spacing);
  return raster;
}

}  // namespace

template <typename Dimension>
class ThinPlateBasisOf : public ::testing::Test {
 public:
  static constexpr int kDim = Dimension::value;
  std::shared_ptr<const ThinPlateBasis<kDim>> basis =
      testing::thin_plates_over<kDim>(box_of<kDim>(60, 5), kDim == 2 ? 6 : 4);
  std::vector<Point<kDim>> points() const {
    testing::Numbers numbers(2);
    std::vector<Point<kDim>> inside_and_out;
    for (int k = 0; k < 30; ++k)
      inside_and_out.push_back(numbers.columns<kDim>(1, 60).array() + 35);
    return inside_and_out;
  }
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(ThinPlateBasisOf, Dimensions);

TYPED_TEST(ThinPlateBasisOf, IsCardinal) {
  const auto& centres = this->basis->centres();
  for (int i = 0; i < centres.cols(); ++i) {
    const auto at = this->basis->evaluate(centres.col(i));
    EXPECT_EQ(at.control_points, std::vector<int>{i});
    EXPECT_EQ(at.values[0], 1);
  }
  // Not only because centres are recognised.
  const Eigen::MatrixXd values = this->basis->values(centres);
  EXPECT_LT((values - Eigen::MatrixXd::Identity(values.rows(), values.cols())).norm(), 1e-9);
}

TYPED_TEST(ThinPlateBasisOf, ReproducesAffineMaps) {
  for (const auto& x : this->points()) {
    const auto at = this->basis->evaluate(x, 2);
    EXPECT_NEAR(at.values.sum(), 1, 1e-11);
    EXPECT_LT((this->basis->centres() * at.values - x).norm(), 1e-9);
    EXPECT_LT(
        (this->basis->centres() * at.gradients.transpose() - Matrix<TestFixture::kDim>::Identity())
            .norm(),
        1e-10);
    EXPECT_LT((this->basis->centres() * at.hessians.transpose()).norm(), 1e-10);
  }
}

TYPED_TEST(ThinPlateBasisOf, DerivativesMatchCentralDifferences) {
  constexpr int Dim = TestFixture::kDim;
  constexpr double kStep = 1e-4;
  for (const auto& x : this->points()) {
    const auto at = this->basis->evaluate(x, 2);
    for (int a = 0, s = 0; a < Dim; ++a) {
      const Vector<Dim> h = kStep * Vector<Dim>::Unit(a);
      const auto plus = this->basis->evaluate(x + h, 1), minus = this->basis->evaluate(x - h, 1);
      EXPECT_LT((at.gradients.row(a).transpose() - (plus.values - minus.values) / (2 * kStep))
                    .cwiseAbs()
                    .maxCoeff(),
                1e-7);
      for (int b = a; b < Dim; ++b, ++s) {
        EXPECT_LT(
            (at.hessians.row(s) - (plus.gradients.row(b) - minus.gradients.row(b)) / (2 * kStep))
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
      }
    }
  }
}

TYPED_TEST(ThinPlateBasisOf, SumsAreTheFunctionsTimesTheirControlPoints) {
  constexpr int Dim = TestFixture::kDim;
  const ControlPoints<Dim> phi =
      testing::Numbers(5).columns<Dim>(this->basis->num_control_points(), 3);
  const auto sum = this->basis->sum(phi);
  for (const auto& x : this->points()) {
    const auto at = this->basis->evaluate(x, 2);
    const Eigen::MatrixXd found = sum->evaluate(x, 2);
    EXPECT_LT((found.col(0) - phi * at.values).norm(), 1e-10);
    EXPECT_LT((found.template middleCols<Dim>(1) - phi * at.gradients.transpose()).norm(), 1e-11);
    EXPECT_LT((found.rightCols(at.hessians.rows()) - phi * at.hessians.transpose()).norm(), 1e-11);
    EXPECT_EQ(sum->evaluate(x, 0), found.col(0));
  }
}

TYPED_TEST(ThinPlateBasisOf, DerivativesAreFiniteAtCentres) {
  const auto at = this->basis->evaluate(this->basis->centres().col(3), 2);
  EXPECT_TRUE(at.gradients.allFinite());
  EXPECT_TRUE(at.hessians.allFinite());
  EXPECT_NEAR(at.values.sum(), 1, 1e-12);
}

// The closed form against the integral over larger and larger boxes, by midpoints of cells that grow with
// the distance. What lies beyond a box of half width R falls off like R^-2 (2D) and R^-3 (3D).
TYPED_TEST(ThinPlateBasisOf, BendingMatrixIsTheIntegralOverAllOfSpace) {
  constexpr int Dim = TestFixture::kDim, kCells = Dim == 2 ? 200 : 60;
  const ThinPlateBasis<Dim> few(testing::Numbers(12).columns<Dim>(Dim + 3, 3));
  const ControlPoints<Dim> phi = testing::Numbers(13).columns<Dim>(Dim + 3);
  const auto sum = few.sum(phi);
  const double closed = (phi * *few.bending_matrix() * phi.transpose()).trace();
  double integral = 0, before = 0, inner = 0;
  for (const double reach : {5, 10, 20, 40}) {
    const double cell = 2 * reach / kCells;
    before = integral;
    for (int n = 0; n < std::pow(kCells, Dim); ++n) {
      Point<Dim> x;
      for (int a = 0, rest = n; a < Dim; rest /= kCells, ++a) {
        x[a] = (rest % kCells + 0.5) * cell - reach;
      }
      if (x.cwiseAbs().maxCoeff() < inner) continue;
      const Eigen::MatrixXd second = sum->evaluate(x, 2).rightCols(Dim * (Dim + 1) / 2);
      for (int a = 0, s = 0; a < Dim; ++a) {
        for (int b = a; b < Dim; ++b, ++s) {
          integral += (a == b ? 1 : 2) * second.col(s).squaredNorm() * std::pow(cell, Dim);
        }
      }
    }
    inner = reach;
  }
  const double beyond = (integral - before) / (Dim == 2 ? 3 : 7);
  EXPECT_LT(beyond, 0.01 * closed);
  EXPECT_NEAR(integral + beyond, closed, (Dim == 2 ? 0.003 : 0.05) * closed);
}

TYPED_TEST(ThinPlateBasisOf, BendingIsClosedFormWithoutWeights) {
  constexpr int Dim = TestFixture::kDim;
  const Eigen::MatrixXd closed = *this->basis->bending_matrix();
  EXPECT_EQ(Eigen::MatrixXd(BendingEnergy<Dim>(*this->basis).matrix()), closed);
  EXPECT_EQ(Eigen::MatrixXd(BendingEnergy<Dim>(*this->basis, body_weights<Dim>()).matrix()),
            closed);
  EXPECT_LT((closed - closed.transpose()).norm(), 1e-13 * closed.norm());
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(closed, Eigen::EigenvaluesOnly).eigenvalues();
  EXPECT_GT(eigenvalues[0], -1e-12 * eigenvalues.maxCoeff());
  EXPECT_LT(eigenvalues[Dim], 1e-12 * eigenvalues.maxCoeff());  // affine maps do not bend
  EXPECT_GT(eigenvalues[Dim + 1], 1e-5 * eigenvalues.maxCoeff());
}

// The accuracy that quadrature() states, against rules of many more points.
TYPED_TEST(ThinPlateBasisOf, QuadratureIsAsAccurateAsItSays) {
  constexpr int Dim = TestFixture::kDim;
  const auto plates = covering_thin_plate<Dim>(raster_of<Dim>(40, 1), Dim == 2 ? 8 : 20);
  const auto trace = [&](int degree, int derivatives) {  // the sum over functions of int |..|^2
    double sum = 0;
    for (const auto& element : plates->quadrature(degree, derivatives)) {
      if (derivatives == 1) {
        for (const auto& g : element.gradients) sum += (g.cwiseAbs2() * element.weights).sum();
      } else {
        for (int a = 0, s = 0; a < Dim; ++a) {
          for (int b = a; b < Dim; ++b, ++s) {
            sum += (a == b ? 1 : 2) * (element.hessians[s].cwiseAbs2() * element.weights).sum();
          }
        }
      }
    }
    return sum;
  };
  const int fine = Dim == 2 ? 31 : 9;
  EXPECT_NEAR(trace(3, 1), trace(fine, 1), (Dim == 2 ? 1e-3 : 0.01) * trace(fine, 1));
  EXPECT_NEAR(trace(3, 2), trace(fine, 2), (Dim == 2 ? 0.01 : 0.1) * trace(fine, 2));
  EXPECT_NEAR(trace(7, 2), trace(fine, 2), (Dim == 2 ? 0.01 : 0.1) * trace(fine, 2));
  double volume = 0;
  for (const auto& element : plates->quadrature(3, 0)) volume += element.weights.sum();
  EXPECT_NEAR(volume, plates->measure(), 1e-9 * volume);
}

TYPED_TEST(ThinPlateBasisOf, IsBoundByTablesOrThroughALattice) {
  constexpr int Dim = TestFixture::kDim;
  const auto small = this->basis->bind(raster_of<Dim>(16, 4));
  EXPECT_NE(dynamic_cast<SparseRowGrid<Dim>*>(small.get()), nullptr);
  const auto large = this->basis->bind(raster_of<Dim>(Dim == 2 ? 400 : 40, Dim == 2 ? 0.2 : 2));
  EXPECT_NE(dynamic_cast<LatticeGrid<Dim>*>(large.get()), nullptr);
}

TYPED_TEST(ThinPlateBasisOf, SameBytesOnAnyNumberOfThreads) {
  constexpr int Dim = TestFixture::kDim;
  const ControlPoints<Dim> points = testing::Numbers(3).columns<Dim>(500, 40);
  set_num_threads(1);
  const Eigen::MatrixXd one = this->basis->values(points);
  set_num_threads(4);
  EXPECT_EQ(one, this->basis->values(points));
  set_num_threads(0);
}

TEST(ThinPlateBasis, RefusesCentresThatCoincide) {
  ControlPoints<2> centres = testing::jittered_centres<2>(box_of<2>(10), 3);
  centres.col(7) = centres.col(2);
  EXPECT_THAT([&] { ThinPlateBasis<2>{centres}; },
              ThrowsMessage<InvalidInput>(HasSubstr("centres 2 and 7 coincide")));
}

TEST(ThinPlateBasis, RefusesCentresOnALineOrPlane) {
  const ControlPoints<2> line{{0, 1, 2, 7}, {1, 2, 3, 8}};
  EXPECT_THAT([&] { ThinPlateBasis<2>{line}; },
              ThrowsMessage<InvalidInput>(HasSubstr("on one line")));
  ControlPoints<3> plane = testing::Numbers(4).columns<3>(9, 20);
  plane.row(2) = plane.row(0) - 0.5 * plane.row(1);
  EXPECT_THAT([&] { ThinPlateBasis<3>{plane}; },
              ThrowsMessage<InvalidInput>(HasSubstr("on one plane")));
  EXPECT_THROW((ThinPlateBasis<3>{ControlPoints<3>::Random(3, 3)}), InvalidInput);
  plane(1, 4) = std::nan("");
  EXPECT_THAT([&] { ThinPlateBasis<3>{plane}; },
              ThrowsMessage<InvalidInput>(HasSubstr("centre 4")));
}

TEST(CoveringCentres, AreALatticeWithItsBorder) {
  Raster<2> raster = raster_of<2>(100, 0.5);
  raster.size[1] = 60;
  raster.direction = testing::turned<2>(0.3);
  const auto centres = covering_centres<2>(raster, 10, {});
  EXPECT_EQ(centres.cols(), 6 * 4);
  EXPECT_LT((centres.col(0) - raster.point({-0.5, -0.5})).norm(), 1e-12);
  EXPECT_LT((centres.col(23) - raster.point({99.5, 59.5})).norm(), 1e-12);
  EXPECT_NEAR((centres.col(1) - centres.col(0)).norm(), 10, 1e-12);
}

TEST(CoveringCentres, GiveWayToLandmarks) {
  const std::vector<Point<2>> landmarks = {{10.6, 9.4}, {15, 15}, {10.6, 9.4}, {80, 3}};
  const auto centres = covering_centres<2>(raster_of<2>(41, 1), 10, landmarks);
  ASSERT_EQ(centres.cols(),
            25 - 1 + 3);  // one lattice point makes room, one landmark is there twice
  EXPECT_EQ(centres.col(24), landmarks[0]);
  EXPECT_EQ(centres.col(25), landmarks[1]);
  EXPECT_EQ(centres.col(26), landmarks[3]);
}

TEST(CoveringCentres, AreNoMoreThanTheirMost) {
  const auto plane = covering_centres<2>(raster_of<2>(512, 1), 1, {});
  EXPECT_LE(plane.cols(), kMostLatticeCentres<2>);
  EXPECT_GE(plane.cols(), 361);
  EXPECT_LE(covering_centres<3>(raster_of<3>(64, 1), 2, {}).cols(), kMostLatticeCentres<3>);
  EXPECT_EQ(covering_centres<3>(raster_of<3>(64, 1), 1e6, {}).cols(), 8);
  EXPECT_THROW(covering_centres<2>(raster_of<2>(64, 1), 0, {}), InvalidInput);
  EXPECT_THROW(covering_centres<2>(Raster<2>(), 1, {}), InvalidInput);
}

}  // namespace crease

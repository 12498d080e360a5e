#include "Transforms/CauchyNavierTransform.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Testing/Transforms/SampleCentres.h"
#include "Testing/Transforms/SampleSplines.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

template <int Dim>
Box<Dim> box_of(double size) {
  Box<Dim> box;
  box.add(Point<Dim>::Constant(5));
  box.add(Point<Dim>::Constant(5 + size));
  return box;
}

}  // namespace

template <typename Dimension>
class CauchyNavierOf : public ::testing::Test {
 public:
  static constexpr int kDim = Dimension::value;
  static constexpr double kRatio = 0.42;
  /// 25 or 27 centres, 12 or 20 mm apart, moved by up to 3 mm.
  static CauchyNavierTransform<kDim> moved(double unit = 1, const AffineMap<kDim>& affine = {}) {
    const ControlPoints<kDim> centres =
        unit * testing::jittered_centres<kDim>(box_of<kDim>(60), kDim == 2 ? 5 : 3);
    CauchyNavierTransform<kDim> transform(centres, kRatio, affine);
    transform.set_parameters(
        testing::Numbers(6).columns<1>(transform.num_parameters(), 3 * unit).transpose());
    return transform;
  }
  static std::vector<Point<kDim>> points() {
    testing::Numbers numbers(2);
    std::vector<Point<kDim>> inside_and_out;
    for (int k = 0; k < 20; ++k)
      inside_and_out.push_back(numbers.columns<kDim>(1, 60).array() + 35);
    return inside_and_out;
  }
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(CauchyNavierOf, Dimensions);

TYPED_TEST(CauchyNavierOf, TakesItsValuesAtTheCentres) {
  constexpr int Dim = TestFixture::kDim;
  AffineMap<Dim> affine{1.1 * testing::turned<Dim>(0.4), Vector<Dim>::Constant(3)};
  for (const double unit : {1e-3, 1.0, 1e4}) {  // whatever the unit of length
    const auto transform = TestFixture::moved(unit, affine);
    for (int i = 0; i < transform.centres().cols(); ++i) {
      const Point<Dim> x = transform.centres().col(i);
      EXPECT_LT((transform.map(x) - affine(x) - transform.displacements().col(i)).norm(),
                1e-10 * 60 * unit);
    }
  }
}

// div grad u + grad div u / (1 - 2 nu) = -f / mu with the forces of the header, whose weights the roughness
// knows: R = 180 pi (1 - nu) E in the plane, 1152 pi (1 - nu) E in space.
TYPED_TEST(CauchyNavierOf, SolvesNaviersEquation) {
  constexpr int Dim = TestFixture::kDim;
  constexpr double kStep = 1e-3;
  const double nu = TestFixture::kRatio;
  const auto transform = TestFixture::moved();
  const Eigen::MatrixXd E =
      *transform.roughness_matrix() / ((Dim == 2 ? 180 : 1152) * std::numbers::pi * (1 - nu));
  const Eigen::VectorXd weights = E * transform.parameters();
  const ControlPoints<Dim> w = weights.reshaped(Dim, transform.centres().cols());
  for (const auto& x : this->points()) {
    Vector<Dim> laplacian = Vector<Dim>::Zero(), gradient_of_divergence = Vector<Dim>::Zero();
    for (int b = 0; b < Dim; ++b) {
      const Vector<Dim> h = kStep * Vector<Dim>::Unit(b);
      const Matrix<Dim> bend =
          (transform.spatial_jacobian(x + h) - transform.spatial_jacobian(x - h)) / (2 * kStep);
      laplacian += bend.col(b);
      gradient_of_divergence[b] = bend.trace();
    }
    Vector<Dim> force = Vector<Dim>::Zero();  // over mu
    double size = 0;
    for (int i = 0; i < w.cols(); ++i) {
      const double scale =
          2 * (Dim == 2 ? 45 : 72) * (1 - nu) * (x - transform.centres().col(i)).norm();
      force -= scale * w.col(i);
      size += scale * w.col(i).norm();
    }
    EXPECT_LT((laplacian + gradient_of_divergence / (1 - 2 * nu) + force).norm(), 1e-6 * size);
  }
}

TYPED_TEST(CauchyNavierOf, ReproducesAffineMapsEverywhere) {
  constexpr int Dim = TestFixture::kDim;
  auto transform = TestFixture::moved();
  AffineMap<Dim> map{1.2 * testing::turned<Dim>(0.8), Vector<Dim>::Constant(5)};
  map.linear(0, Dim - 1) += 0.4;
  ControlPoints<Dim> shifts = transform.centres();
  shifts = ((map.linear - Matrix<Dim>::Identity()) * shifts).colwise() + map.offset;
  transform.set_parameters(shifts.reshaped());
  const Point<Dim> far = Point<Dim>::LinSpaced(900, -700);
  EXPECT_LT((transform.map(far) - map(far)).norm(), 1e-6);
  EXPECT_LT((transform.spatial_jacobian(far) - map.linear).norm(), 1e-9);
  const Eigen::VectorXd p = transform.parameters();
  EXPECT_LT(p.dot(*transform.roughness_matrix() * p), 1e-12 * p.squaredNorm());
}

TYPED_TEST(CauchyNavierOf, RoughnessIsZeroForAffineMapsOnly) {
  constexpr int Dim = TestFixture::kDim;
  const Eigen::MatrixXd R = *TestFixture::moved().roughness_matrix();
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(R, Eigen::EigenvaluesOnly).eigenvalues();
  constexpr int kAffine = Dim * (Dim + 1);
  EXPECT_LT(eigenvalues.head(kAffine).cwiseAbs().maxCoeff(), 1e-12 * eigenvalues.maxCoeff());
  EXPECT_GT(eigenvalues[kAffine], 1e-6 * eigenvalues.maxCoeff());
}

// A centre pulled along the first axis squeezes what lies before it and draws in what lies beside it:
// the more so, the less the body can be compressed. Thin plates would not move the second coordinate.
TYPED_TEST(CauchyNavierOf, CouplesTheCoordinates) {
  constexpr int Dim = TestFixture::kDim;
  const auto sideways = [&](double ratio) {
    const auto centres = testing::jittered_centres<Dim>(box_of<Dim>(60), 3);
    CauchyNavierTransform<Dim> transform(centres, ratio);
    Eigen::VectorXd v = Eigen::VectorXd::Zero(transform.num_parameters());
    v[Dim * (centres.cols() / 2)] = 5;
    transform.set_parameters(v);
    Point<Dim> x = centres.col(centres.cols() / 2);
    x[0] += 8;
    x[1] += 8;
    return transform.map(x)[1] - x[1];
  };
  EXPECT_GT(std::abs(sideways(0.3)), 0.05);
  EXPECT_GT(std::abs(sideways(0.49)), 1.2 * std::abs(sideways(0.0)));
}

TYPED_TEST(CauchyNavierOf, SmoothedValuesAreAMinimum) {
  constexpr int Dim = TestFixture::kDim;
  const auto transform = TestFixture::moved();
  const ControlPoints<Dim>& y = transform.displacements();
  Eigen::VectorXd variances = Eigen::VectorXd::Constant(y.cols(), 2e5);
  variances[3] = 0;
  const ControlPoints<Dim> f = transform.smoothed(y, variances);
  EXPECT_LT((f.col(3) - y.col(3)).norm(), 1e-10);
  EXPECT_GT((f.col(4) - y.col(4)).norm(), 0.1);
  const auto cost = [&](const ControlPoints<Dim>& g) {
    const Eigen::VectorXd p = g.reshaped();
    double sum = p.dot(*transform.roughness_matrix() * p);
    for (int i = 0; i < g.cols(); ++i) {
      if (variances[i] > 0) sum += (g.col(i) - y.col(i)).squaredNorm() / variances[i];
    }
    return sum;
  };
  for (int i = 0; i < f.cols(); ++i) {
    if (i == 3) continue;
    for (double step : {1e-2, -1e-2}) {
      ControlPoints<Dim> changed = f;
      changed(1, i) += step;
      EXPECT_GT(cost(changed), cost(f));
    }
  }
}

TYPED_TEST(CauchyNavierOf, RefusesBadBodies) {
  constexpr int Dim = TestFixture::kDim;
  ControlPoints<Dim> centres = testing::jittered_centres<Dim>(box_of<Dim>(60), 3);
  for (const double ratio : {0.5, -1.0, 0.7, std::nan("")}) {
    EXPECT_THAT([&] { CauchyNavierTransform<Dim>(centres, ratio); },
                ThrowsMessage<InvalidInput>(HasSubstr("below 0.5")));
  }
  centres.col(5) = centres.col(1);
  EXPECT_THAT([&] { CauchyNavierTransform<Dim>{centres}; },
              ThrowsMessage<InvalidInput>(HasSubstr("centres 1 and 5 coincide")));
  centres.row(0).setConstant(3);
  EXPECT_THAT([&] { CauchyNavierTransform<Dim>{centres}; },
              ThrowsMessage<InvalidInput>(HasSubstr(Dim == 2 ? "on one line" : "on one plane")));
}

TYPED_TEST(CauchyNavierOf, JacobianAtCentresIsExact) {
  constexpr int Dim = TestFixture::kDim;
  const auto transform = TestFixture::moved();
  const std::vector<Point<Dim>> x = {transform.centres().col(2)};
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(transform.num_parameters(), Dim);
  expected.template middleRows<Dim>(2 * Dim).setIdentity();
  EXPECT_EQ(transform.parameter_jacobian(x), expected);
}

TYPED_TEST(CauchyNavierOf, SameBytesOnAnyNumberOfThreads) {
  constexpr int Dim = TestFixture::kDim;
  const auto transform = TestFixture::moved();
  std::vector<Point<Dim>> x;
  std::vector<Vector<Dim>> forces;
  testing::Numbers numbers(8);
  for (int k = 0; k < 1000; ++k) {
    x.push_back(numbers.columns<Dim>(1, 60));
    forces.push_back(numbers.columns<Dim>(1));
  }
  const auto run = [&] {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(transform.num_parameters());
    transform.add_adjoint(x, forces, gradient);
    return std::pair(gradient, transform.parameter_jacobian(x));
  };
  set_num_threads(1);
  const auto one = run();
  set_num_threads(4);
  EXPECT_EQ(one, run());
  set_num_threads(0);
}

}  // namespace crease

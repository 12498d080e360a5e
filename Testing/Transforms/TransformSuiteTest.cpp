// What every transform obeys, written once.
#include <gtest/gtest.h>

#include <filesystem>

#include "Core/Error.h"
#include "Testing/Transforms/SampleCentres.h"
#include "Testing/Transforms/SampleNurbs.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/CauchyNavierTransform.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/DisplacementFieldTransform.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SimilarityTransform.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"
#include "Transforms/TransformFile.h"
#include "Transforms/TransformSampler.h"

namespace crease {
namespace {

using testing::Numbers;

template <int Dim>
Point<Dim> centre() {
  Point<Dim> c;
  for (int a = 0; a < Dim; ++a) c[a] = 4 - a;
  return c;
}

template <int Dim>
struct Affine {
  static constexpr int kIn = Dim, kOut = Dim;
  static std::unique_ptr<Transform<Dim>> make() {
    return std::make_unique<AffineTransform<Dim>>(centre<Dim>());
  }
};

template <int Dim>
struct Rigid {
  static constexpr int kIn = Dim, kOut = Dim;
  static std::unique_ptr<Transform<Dim>> make() {
    return std::make_unique<RigidTransform<Dim>>(centre<Dim>());
  }
};

template <int Dim>
struct Similarity {
  static constexpr int kIn = Dim, kOut = Dim;
  static std::unique_ptr<Transform<Dim>> make() {
    return std::make_unique<SimilarityTransform<Dim>>(centre<Dim>());
  }
};

/// The box of the points of all tests, and some more.
template <int Dim>
Box<Dim> test_box() {
  Box<Dim> box;
  for (const auto& x : testing::points_inside<Dim>(testing::small_lattice<Dim>(), 50)) box.add(x);
  return box;
}

template <int Dim>
struct ThinPlate {
  static constexpr int kIn = Dim, kOut = Dim;
  static std::unique_ptr<Transform<Dim>> make() {
    return std::make_unique<SplineTransform<Dim>>(
        testing::thin_plates_over<Dim>(test_box<Dim>(), 3));
  }
};

template <int Dim>
struct CauchyNavier {
  static constexpr int kIn = Dim, kOut = Dim;
  static std::unique_ptr<Transform<Dim>> make() {
    return std::make_unique<CauchyNavierTransform<Dim>>(
        testing::jittered_centres<Dim>(test_box<Dim>(), 3), 0.4);
  }
};

template <int Dim, int Degree>
struct TensorSpline {
  static constexpr int kIn = Dim, kOut = Dim;
  static std::unique_ptr<Transform<Dim>> make() {
    return std::make_unique<SplineTransform<Dim>>(testing::small_basis<Dim>(Degree));
  }
};

/// Over 40 x 40 mm: the points of all tests lie inside.
template <int Degree>
struct TriangularSpline {
  static constexpr int kIn = 2, kOut = 2;
  static std::unique_ptr<Transform<2>> make() {
    auto net = testing::jittered_net(4, 4, Degree, 0.3, 7);
    const Point<2> shift(-12, -13);
    for (auto& v : net.mesh.vertices) v += shift;
    for (auto& cloud : net.clouds) {
      for (auto& knot : cloud) knot += shift;
    }
    return std::make_unique<SplineTransform<2>>(
        std::make_shared<TriangularBSplineBasis<2>>(std::move(net)));
  }
};

/// Over the same 40 x 40 mm.
struct PowellSabinSpline {
  static constexpr int kIn = 2, kOut = 2;
  static std::unique_ptr<Transform<2>> make() {
    auto mesh = testing::jittered_mesh(4, 4, 7);
    for (auto& v : mesh.vertices) v += Vector<2>(-12, -13);
    return std::make_unique<SplineTransform<2>>(std::make_shared<PowellSabinBasis>(mesh));
  }
};

template <int Dim, int Degree>
struct Nurbs {
  static constexpr int kIn = Dim, kOut = Dim;
  static std::unique_ptr<Transform<Dim>> make() {
    return std::make_unique<SplineTransform<Dim>>(std::make_shared<NurbsBasis<Dim>>(
        testing::rational_net<Dim>(testing::small_lattice<Dim>(), Degree)));
  }
};

template <int Degree>
struct TSpline {
  static constexpr int kIn = 2, kOut = 2;
  static std::unique_ptr<Transform<2>> make() {
    return std::make_unique<SplineTransform<2>>(
        testing::tspline(testing::small_lattice<2>(), Degree));
  }
};

struct TensorShell {
  static constexpr int kIn = 2, kOut = 3;
  static std::unique_ptr<Transform<2, 3>> make() {
    return std::make_unique<SplineTransform<2, 3>>(testing::small_basis<2>(3));
  }
};

/// Over the lattice of all tests, and turned as that is; its samples are no multiples of the lattice's.
template <int Dim>
struct Field {
  static constexpr int kIn = Dim, kOut = Dim;
  static std::unique_ptr<Transform<Dim>> make() {
    const auto lattice = testing::small_lattice<Dim>();
    Raster<Dim> raster;
    raster.origin = lattice.origin;
    raster.direction = lattice.direction;
    raster.spacing = 0.37 * lattice.spacing;
    for (int a = 0; a < Dim; ++a) raster.size[a] = 3 * lattice.spans[a] + 1;
    return std::make_unique<DisplacementFieldTransform<Dim>>(raster);
  }
};

template <int Dim>
struct Composite {
  static constexpr int kIn = Dim, kOut = Dim;
  static std::unique_ptr<Transform<Dim>> make() {
    std::vector<std::unique_ptr<Transform<Dim>>> parts;
    parts.push_back(Rigid<Dim>::make());
    parts.push_back(TensorSpline<Dim, 3>::make());
    parts.push_back(Affine<Dim>::make());
    return std::make_unique<CompositeTransform<Dim>>(std::move(parts));
  }
};

}  // namespace

template <typename Kind>
class TransformSuite : public ::testing::Test {
 public:
  static constexpr int kIn = Kind::kIn, kOut = Kind::kOut;

  /// Moved away from rest by parameters of the size given; small, so that parts stay in their domains.
  static std::unique_ptr<Transform<kIn, kOut>> moved(double size = 0.05) {
    auto transform = Kind::make();
    Numbers numbers(11);
    const Eigen::VectorXd step = numbers.columns<1>(transform->num_parameters(), size).transpose();
    transform->set_parameters(transform->parameters() + step);
    return transform;
  }
  static std::vector<Point<kIn>> points(int count = 20) {
    return testing::points_inside<kIn>(testing::small_lattice<kIn>(), count, 0.6);
  }
};

using Kinds =
    ::testing::Types<Affine<2>, Affine<3>, Rigid<2>, Rigid<3>, Similarity<2>, Similarity<3>,
                     ThinPlate<2>, ThinPlate<3>, CauchyNavier<2>, CauchyNavier<3>,
                     TensorSpline<2, 2>, TensorSpline<2, 3>, TensorSpline<2, 5>, TensorSpline<3, 3>,
                     TriangularSpline<2>, TriangularSpline<3>, PowellSabinSpline, Nurbs<2, 2>,
                     Nurbs<2, 3>, Nurbs<3, 3>, TSpline<3>, TSpline<5>, TensorShell, Field<2>,
                     Field<3>, Composite<2>, Composite<3>>;
TYPED_TEST_SUITE(TransformSuite, Kinds);

TYPED_TEST(TransformSuite, IsTheIdentityAtRest) {
  const auto transform = TypeParam::make();
  for (const auto& x : this->points()) {
    Point<TypeParam::kOut> expected = Point<TypeParam::kOut>::Zero();
    expected.template head<TypeParam::kIn>() = x;
    EXPECT_LT((transform->map(x) - expected).norm(), 1e-14);
    EXPECT_TRUE(transform->in_domain(x));
  }
}

TYPED_TEST(TransformSuite, SpatialJacobianMatchesCentralDifferences) {
  const auto transform = this->moved();
  constexpr double kStep = 1e-5;
  for (const auto& x : this->points()) {
    const auto jacobian = transform->spatial_jacobian(x);
    for (int a = 0; a < TypeParam::kIn; ++a) {
      Point<TypeParam::kIn> h = Point<TypeParam::kIn>::Zero();
      h[a] = kStep;
      const Point<TypeParam::kOut> difference =
          (transform->map(x + h) - transform->map(x - h)) / (2 * kStep);
      EXPECT_LT((jacobian.col(a) - difference).norm(), 1e-8);
    }
  }
}

TYPED_TEST(TransformSuite, SamplerSeesWhatSingleSamplesDo) {
  const auto transform = this->moved();
  auto x = this->points(40);
  for (std::size_t k = 0; k < 20; ++k) x.push_back(3.0 * x[k]);  // most of them outside
  std::vector<typename Transform<TypeParam::kIn, TypeParam::kOut>::Sample> samples(x.size());
  transform->sampler()->sample(x, samples);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto one = transform->sample(x[k]);
    EXPECT_LT((samples[k].point - one.point).norm(), 1e-10 * (1 + one.point.norm()));
    EXPECT_LT((samples[k].jacobian - one.jacobian).norm(), 1e-10 * (1 + one.jacobian.norm()));
    EXPECT_EQ(samples[k].in_domain, one.in_domain);
  }
}

TYPED_TEST(TransformSuite, AdjointIsTheTransposedJacobianByParameters) {
  const auto transform = this->moved();
  const auto x = this->points(7);
  Numbers numbers(3);
  std::vector<Vector<TypeParam::kOut>> forces;
  for (std::size_t k = 0; k < x.size(); ++k) {
    forces.push_back(numbers.columns<TypeParam::kOut>(1));
  }
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(transform->num_parameters());
  transform->add_adjoint(x, forces, gradient);

  const Eigen::VectorXd p = transform->parameters();
  constexpr double kStep = 1e-5;
  for (int trial = 0; trial < 5; ++trial) {
    const Eigen::VectorXd direction = numbers.columns<1>(p.size()).transpose();
    double difference = 0;
    for (const double sign : {1.0, -1.0}) {
      transform->set_parameters(p + sign * kStep * direction);
      for (std::size_t k = 0; k < x.size(); ++k) {
        difference += sign * forces[k].dot(transform->map(x[k])) / (2 * kStep);
      }
    }
    EXPECT_NEAR(gradient.dot(direction), difference, 1e-7 * (1 + std::abs(difference)));
  }
}

TYPED_TEST(TransformSuite, ParameterJacobianHoldsTheAdjointsOfUnitForces) {
  const auto transform = this->moved();
  const auto x = this->points(5);
  const Eigen::MatrixXd jacobian = transform->parameter_jacobian(x);
  ASSERT_EQ(jacobian.rows(), transform->num_parameters());
  ASSERT_EQ(jacobian.cols(), TypeParam::kOut * std::ssize(x));
  Numbers numbers(3);
  std::vector<Vector<TypeParam::kOut>> forces;
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(jacobian.rows());
  for (std::size_t k = 0; k < x.size(); ++k) {
    forces.push_back(numbers.columns<TypeParam::kOut>(1));
    expected += jacobian.middleCols<TypeParam::kOut>(TypeParam::kOut * k) * forces.back();
  }
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(transform->num_parameters());
  transform->add_adjoint(x, forces, gradient);
  EXPECT_LT((gradient - expected).norm(), 1e-12 * gradient.norm());
}

TYPED_TEST(TransformSuite, SaysTrulyThatItIsLinearInItsParameters) {
  const auto transform = this->moved();
  const auto x = this->points(1)[0];
  const Eigen::VectorXd p = transform->parameters();
  const Eigen::VectorXd step = Numbers(4).columns<1>(p.size(), 0.3).transpose();
  const auto at = [&](double t) {
    transform->set_parameters(p + t * step);
    return transform->map(x);
  };
  const double bend = (at(1) - 2 * at(0) + at(-1)).norm();
  if (transform->linear_in_parameters()) {
    EXPECT_LT(bend, 1e-12);
  } else {
    EXPECT_GT(bend, 1e-6);
  }
}

TYPED_TEST(TransformSuite, AdjointAddsToWhatIsThere) {
  const auto transform = this->moved();
  const auto x = this->points(2);
  const std::vector<Vector<TypeParam::kOut>> forces(2, Vector<TypeParam::kOut>::Ones());
  Eigen::VectorXd once = Eigen::VectorXd::Zero(transform->num_parameters());
  transform->add_adjoint(x, forces, once);
  Eigen::VectorXd again = once;
  transform->add_adjoint(x, forces, again);
  EXPECT_LT((again - 2 * once).norm(), 1e-13 * once.norm());
}

TYPED_TEST(TransformSuite, CloneIsIndependent) {
  const auto transform = this->moved();
  const auto copy = transform->clone();
  const auto x = this->points(1)[0];
  const auto before = transform->map(x);
  EXPECT_EQ(copy->map(x), before);
  copy->set_parameters(copy->parameters().array() + 0.1);
  EXPECT_EQ(transform->map(x), before);
  EXPECT_GT((copy->map(x) - before).norm(), 1e-3);
}

TYPED_TEST(TransformSuite, RefusesWrongParameters) {
  const auto transform = this->moved();
  const Eigen::VectorXd p = transform->parameters();
  EXPECT_EQ(p.size(), transform->num_parameters());
  EXPECT_THROW(transform->set_parameters(p.head(p.size() - 1)), InvalidInput);
  Eigen::VectorXd bad = p;
  bad[p.size() / 2] = std::nan("");
  EXPECT_THROW(transform->set_parameters(bad), InvalidInput);
  EXPECT_EQ(transform->parameters(), p);
}

TYPED_TEST(TransformSuite, FileKeepsEveryBit) {
  const auto transform = this->moved();
  const auto file =
      std::filesystem::path(::testing::TempDir()) /
      (std::string("transform") +
       ::testing::UnitTest::GetInstance()->current_test_info()->type_param() + ".json");
  const auto safe = file.parent_path() / std::to_string(std::hash<std::string>()(file.string()));
  save_transform(*transform, safe);
  const auto info = peek_transform(safe);
  EXPECT_EQ(info.in_dim, TypeParam::kIn);
  EXPECT_EQ(info.out_dim, TypeParam::kOut);
  const auto loaded = load_transform<TypeParam::kIn, TypeParam::kOut>(safe);
  EXPECT_EQ(loaded->parameters(), transform->parameters());
  for (const auto& x : this->points()) {
    EXPECT_EQ(loaded->map(x), transform->map(x));
    EXPECT_EQ(loaded->spatial_jacobian(x), transform->spatial_jacobian(x));
  }
  std::filesystem::remove(safe);
}

TYPED_TEST(TransformSuite, MapsEveryFinitePoint) {
  const auto transform = this->moved();
  const Point<TypeParam::kIn> far = Point<TypeParam::kIn>::Constant(500);
  EXPECT_TRUE(transform->map(far).allFinite());
  EXPECT_TRUE(transform->spatial_jacobian(-far).allFinite());
}

}  // namespace crease

// Known maps of an image recovered by a registration, and identical images left alone.
#include <gtest/gtest.h>

#include <numbers>

#include "Optimizers/GaussNewton.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Registration.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"
#include "Testing/Transforms/SampleSplines.h"

namespace crease {
namespace {

template <int Dim>
struct Tensor {
  static constexpr int kDim = Dim;
  static constexpr int kSize = Dim == 2 ? 128 : 48;
  static std::shared_ptr<const SplineBasis<Dim>> basis(const Box<Dim>& box) {
    return testing::tensor_over<Dim>(box, Dim == 2 ? 6 : 3, 3);
  }
};
struct Triangles {
  static constexpr int kDim = 2, kSize = 128;
  static std::shared_ptr<const SplineBasis<2>> basis(const Box<2>& box) {
    return testing::triangles_over(box, {.degree = 3}, 5);
  }
};
struct PowellSabin {
  static constexpr int kDim = 2, kSize = 128;
  static std::shared_ptr<const SplineBasis<2>> basis(const Box<2>& box) {
    return std::make_shared<PowellSabinBasis>(structured_triangulation(box, 6, 6));
  }
};
using Kinds = ::testing::Types<Tensor<2>, Tensor<3>, Triangles, PowellSabin>;

template <typename Kind>
class RegistrationRecovery : public ::testing::Test {
 public:
  static constexpr int kDim = Kind::kDim;
  Raster<kDim> raster = testing::raster_of<kDim>(Kind::kSize);

  /// The root mean square distance in pixels between a map about the centre, and what is found of it,
  /// over the samples that both images show, two pixels from their borders: nearer, the moving image's
  /// interpolation leans on mirrored samples.
  double error(const AffineMap<kDim>& truth) const {
    Registration<kDim> registration(testing::image_of<kDim>(raster, truth),
                                    testing::scene_image<kDim>(raster));
    const auto basis = Kind::basis(raster.bounds());
    registration.basis(basis)
        .initial({})
        .energy("bending", default_bending_weight(*basis), bending<kDim>())
        .schedule({.levels = 3, .smooth_finest = false})
        .optimizer(std::make_shared<GaussNewton>());
    const auto result = registration.run();
    EXPECT_TRUE(result.improved);
    Box<kDim> inner = raster.bounds();
    inner.lower.array() += 2;
    inner.upper.array() -= 2;
    double sum = 0, count = 0;
    for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
      for (int i = 0; i < raster.size[0]; ++i) {
        const Point<kDim> x = raster.row_start(r) + i * raster.index_to_point().col(0);
        if (!inner.contains(x) || !inner.contains(truth(x))) continue;
        sum += (result.transform->map(x) - truth(x)).squaredNorm();
        ++count;
      }
    }
    return std::sqrt(sum / count);
  }

  /// A rotation about the last axis.
  static Matrix<kDim> turn(double degrees) {
    return testing::turned<kDim>(degrees * std::numbers::pi / 180);
  }
};
TYPED_TEST_SUITE(RegistrationRecovery, Kinds);

}  // namespace

TYPED_TEST(RegistrationRecovery, OfATranslationByThreePixels) {
  constexpr int Dim = TestFixture::kDim;
  Vector<Dim> shift = Vector<Dim>::Constant(-3);
  shift[0] = 3;
  EXPECT_LT(this->error(testing::about_centre<Dim>(this->raster, Matrix<Dim>::Identity(), shift)),
            0.02);
}

TYPED_TEST(RegistrationRecovery, OfARotationByTenDegrees) {
  constexpr int Dim = TestFixture::kDim;
  EXPECT_LT(
      this->error(testing::about_centre<Dim>(this->raster, this->turn(10), Vector<Dim>::Zero())),
      0.02);
}

TYPED_TEST(RegistrationRecovery, OfAnAffineMap) {
  constexpr int Dim = TestFixture::kDim;
  Matrix<Dim> linear = Matrix<Dim>::Identity();
  linear(0, 1) = 0.04;
  linear(1, 1) = 0.97;
  const Vector<Dim> shift = Vector<Dim>::LinSpaced(0.8, -0.5);
  EXPECT_LT(this->error(testing::about_centre<Dim>(this->raster, linear, shift)), 0.02);
}

TYPED_TEST(RegistrationRecovery, LeavesIdenticalImagesAlone) {
  constexpr int Dim = TestFixture::kDim;
  const auto image = testing::scene_image<Dim>(this->raster);
  for (const bool smooth_finest : {false, true}) {
    Registration<Dim> registration(image, image);
    registration.basis(TypeParam::basis(this->raster.bounds()))
        .energy("bending", 1e-3, bending<Dim>())
        .schedule({.smooth_finest = smooth_finest});
    const auto result = registration.run();
    double largest = 0;
    for (std::int64_t r = 0; r < this->raster.num_rows(); ++r) {
      for (int i = 0; i < this->raster.size[0]; i += 7) {
        const Point<Dim> x = this->raster.row_start(r) + i * this->raster.index_to_point().col(0);
        largest = std::max(largest, (result.transform->map(x) - x).norm());
      }
    }
    EXPECT_LT(largest, 1e-6);
  }
}

}  // namespace crease

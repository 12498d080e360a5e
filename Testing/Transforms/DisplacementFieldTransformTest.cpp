#include "Transforms/DisplacementFieldTransform.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Testing/Transforms/SampleSplines.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

template <int Dim>
Raster<Dim> turned_raster() {
  Raster<Dim> raster;
  for (int a = 0; a < Dim; ++a) raster.size[a] = 6 - a;
  raster.origin = Point<Dim>::LinSpaced(-3, 8);
  raster.spacing = Vector<Dim>::LinSpaced(0.5, 2);
  raster.direction = testing::turned<Dim>();
  return raster;
}

template <int Dim>
DisplacementFieldTransform<Dim> random_field(const Raster<Dim>& raster) {
  return {raster, testing::Numbers(3).columns<Dim>(raster.num_samples())};
}

/// An affine function of the index is its own interpolant.
template <int Dim>
void keeps_affine_functions() {
  const auto raster = turned_raster<Dim>();
  testing::Numbers numbers(7);
  const Matrix<Dim> slope = numbers.columns<Dim>(Dim);
  const Vector<Dim> shift = numbers.columns<Dim>(1);
  DisplacementFieldTransform<Dim> field(raster);
  ControlPoints<Dim> u(Dim, raster.num_samples());
  for (std::int64_t n = 0; n < u.cols(); ++n) {
    const Point<Dim> x = raster.row_start(n / raster.size[0]) +
                         double(n % raster.size[0]) * raster.index_to_point().col(0);
    u.col(n) = slope * x + shift;
  }
  field.set_parameters(u.reshaped());
  for (int k = 0; k < 50; ++k) {
    Vector<Dim> index;
    for (int a = 0; a < Dim; ++a) index[a] = (0.5 + 0.5 * numbers()) * (raster.size[a] - 1);
    const Point<Dim> x = raster.point(index);
    EXPECT_LT((field.map(x) - (x + slope * x + shift)).norm(), 1e-13);
    EXPECT_LT((field.spatial_jacobian(x) - Matrix<Dim>::Identity() - slope).norm(), 1e-13);
  }
}

}  // namespace

TEST(DisplacementFieldTransform, KeepsAffineFunctionsBetweenItsSamples) {
  keeps_affine_functions<2>();
  keeps_affine_functions<3>();
}

TEST(DisplacementFieldTransform, IsConstantInTheBorderAndTheIdentityBeyond) {
  const auto raster = turned_raster<2>();
  const auto field = random_field(raster);
  const Point<2> outer = raster.point({0, 2.3});
  const Vector<2> u = field.map(outer) - outer;
  const Point<2> in_border = raster.point({-0.4999, 2.3});
  EXPECT_TRUE(field.in_domain(in_border));
  EXPECT_LT((field.map(in_border) - in_border - u).norm(), 1e-13);
  // Only the second axis is left to vary.
  const auto sample = field.sample(in_border);
  EXPECT_LT(((sample.jacobian - Matrix<2>::Identity()) * raster.direction.col(0)).norm(), 1e-13);
  for (const Vector<2>& index : {Vector<2>(-0.5001, 2), Vector<2>(5.5, 2), Vector<2>(2, 4.5)}) {
    const Point<2> beyond = raster.point(index) + 1e-9 * raster.direction.rowwise().sum();
    EXPECT_FALSE(field.in_domain(beyond));
    EXPECT_EQ(field.map(beyond), beyond);
    EXPECT_EQ(field.spatial_jacobian(beyond), (Matrix<2>::Identity()));
  }
  EXPECT_TRUE(field.in_domain(raster.point({5.4999, 4.4999})));
}

TEST(DisplacementFieldTransform, MayHaveOneSampleAlongAnAxis) {
  Raster<3> raster;
  raster.size = {3, 1, 2};
  const auto field = random_field(raster);
  const Point<3> x(0.5, 0.2, 1);
  const Vector<3> mean = 0.5 * (field.displacements().col(3) + field.displacements().col(4));
  EXPECT_LT((field.map(x) - x - mean).norm(), 1e-15);
  EXPECT_EQ(field.spatial_jacobian(x).col(1), (Vector<3>(0, 1, 0)));
}

TEST(DisplacementFieldTransform, TakesAShearedGrid) {
  auto raster = turned_raster<2>();
  raster.direction(0, 1) += 0.3;
  const auto field = random_field(raster);
  const Point<2> x = raster.point({2, 3});
  EXPECT_LT((field.map(x) - x - field.displacements().col(2 + 3 * 6)).norm(), 1e-13);
}

TEST(DisplacementFieldTransform, SaysWhatIsWrongWithItsGridAndNumbers) {
  const auto refuses = [](const Raster<2>& raster, const char* text) {
    EXPECT_THAT([&] { DisplacementFieldTransform<2>{raster}; },
                ThrowsMessage<InvalidInput>(HasSubstr(text)));
  };
  auto raster = turned_raster<2>();
  raster.size[1] = 0;
  refuses(raster, "axis 1 has 0 samples");
  raster = turned_raster<2>();
  raster.spacing[0] = -1;
  refuses(raster, "the spacing of axis 0 is -1");
  raster = turned_raster<2>();
  raster.direction.col(0) = raster.direction.col(1);
  refuses(raster, "direction invertible");
  raster = turned_raster<2>();
  ControlPoints<2> u = ControlPoints<2>::Zero(2, 29);
  EXPECT_THAT([&] { DisplacementFieldTransform<2>(raster, u); },
              ThrowsMessage<InvalidInput>(HasSubstr("58 parameters given, 60 expected")));
  u = ControlPoints<2>::Zero(2, 30);
  u(1, 3) = std::nan("");
  EXPECT_THAT([&] { DisplacementFieldTransform<2>(raster, u); },
              ThrowsMessage<InvalidInput>(HasSubstr("parameter 7 is nan")));
}

}  // namespace crease

#include <gtest/gtest.h>

#include "Images/CubicBSplineInterpolator.h"
#include "Images/MakeInterpolator.h"
#include "Testing/Images/TestImages.h"

namespace crease {
namespace {

using testing::image_of;
using testing::plain_raster;
using testing::turned_raster;

// A cubic spline reproduces cubic polynomials, here away from the border, where mirroring is felt:
// its influence falls to 0.27^12 = 1.4e-7 after twelve pixels.
template <int Dim>
void expect_cubic_polynomials() {
  std::array<int, Dim> size;
  size.fill(33);
  const auto polynomial = [](const Vector<Dim>& s) {
    const Vector<Dim> t = (s.array() - 16) / 16;
    double value = 0.3 - t[0] + t[0] * t[0] * t[1] - 0.5 * t[1] * t[1] * t[1];
    if constexpr (Dim == 3) value += t[2] * t[2] * t[0] + t[0] * t[1] * t[2] + t[2] * t[2] * t[2];
    return value;
  };
  const CubicBSplineInterpolator<Dim> interpolator(image_of(plain_raster<Dim>(size), polynomial));
  for (double offset : {-3.9, -1.27, 0.5, 2.71}) {
    const Point<Dim> x = Point<Dim>::Constant(16) + offset * Vector<Dim>::LinSpaced(1, 0.3);
    EXPECT_NEAR(interpolator.evaluate(x).value, polynomial(x), 2e-6);
  }
}

TEST(CubicBSplineInterpolator, ReproducesCubicPolynomials) {
  expect_cubic_polynomials<2>();
  expect_cubic_polynomials<3>();
}

TEST(LinearInterpolator, ReproducesLinearFunctions) {
  const auto raster = turned_raster<2>({20, 20});
  const auto f = [](const Point<2>& x) { return 0.5 + 0.01 * x[0] - 0.02 * x[1]; };
  const auto image =
      image_of(raster, [&](const Vector<2>& index) { return f(raster.point(index)); });
  const auto sample = make_interpolator(image, InterpolationKind::kLinear)
                          ->evaluate(raster.point(Vector<2>(7.3, 11.8)));
  EXPECT_NEAR(sample.value, f(raster.point(Vector<2>(7.3, 11.8))), 1e-7);
  EXPECT_NEAR(sample.gradient[0], 0.01, 1e-6);
  EXPECT_NEAR(sample.gradient[1], -0.02, 1e-6);
}

}  // namespace
}  // namespace crease

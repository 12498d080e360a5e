#include "Images/DisplacedInterpolator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Images/CubicBSplineInterpolator.h"
#include "Images/LinearInterpolator.h"
#include "Testing/Images/TestImages.h"

namespace crease {
namespace {

using testing::image_of;
using testing::noise_image;

template <int Dim>
std::array<int, Dim> test_size() {
  std::array<int, Dim> size;
  size.fill(Dim == 2 ? 40 : 15);
  return size;
}

/// An image, and a displacement of some pixels on a coarser raster around it.
template <int Dim>
struct Scene {
  std::shared_ptr<const Interpolator<Dim>> image = std::make_shared<CubicBSplineInterpolator<Dim>>(
      noise_image<Dim>(testing::plain_raster<Dim>(test_size<Dim>())));
  typename DisplacedInterpolator<Dim>::Components displacement;

  Scene() {
    Raster<Dim> raster = testing::plain_raster<Dim>(test_size<Dim>());
    raster.spacing.setConstant(2.5);
    raster.origin.setConstant(-20);
    for (int a = 0; a < Dim; ++a) {
      displacement[a] =
          std::make_shared<CubicBSplineInterpolator<Dim>>(image_of(raster, [&](const auto& i) {
            return 1.5 * std::sin(0.4 * i[(a + 1) % Dim] + a) + 0.3 * std::cos(0.3 * i[a]);
          }));
    }
  }
  DisplacedInterpolator<Dim> displaced() const { return {image, displacement}; }
};

/// Points in the middle of the image, off its nodes.
template <int Dim>
std::vector<Point<Dim>> inner_points() {
  std::vector<Point<Dim>> points;
  for (int n = 0; n < 50; ++n) {
    Point<Dim> p;
    for (int a = 0; a < Dim; ++a) p[a] = 4.37 + std::fmod(n * (0.618 + 0.21 * a), 1.0) * 6;
    points.push_back(p);
  }
  return points;
}

template <int Dim>
void expect_composition() {
  const Scene<Dim> scene;
  const auto displaced = scene.displaced();
  for (const Point<Dim>& y : inner_points<Dim>()) {
    Point<Dim> x = y;
    for (int a = 0; a < Dim; ++a) x[a] += scene.displacement[a]->evaluate(y).value;
    EXPECT_EQ(displaced.evaluate(y).value, scene.image->evaluate(x).value);
    EXPECT_EQ(displaced.evaluate(y).inside, scene.image->evaluate(x).inside);
  }
}

template <int Dim>
void expect_exact_gradient() {
  const auto displaced = Scene<Dim>().displaced();
  constexpr double kStep = 1e-5;
  for (const Point<Dim>& y : inner_points<Dim>()) {
    const Vector<Dim> gradient = displaced.evaluate(y).gradient;
    for (int a = 0; a < Dim; ++a) {
      const Vector<Dim> step = kStep * Vector<Dim>::Unit(a);
      const double slope =
          (displaced.evaluate(y + step).value - displaced.evaluate(y - step).value) / (2 * kStep);
      EXPECT_NEAR(gradient[a], slope, 1e-8);  // second derivatives of noise are below 10
    }
  }
}

template <int Dim>
void expect_rows_agree_with_points() {
  const auto displaced = Scene<Dim>().displaced();
  const std::size_t size = 70;  // longer than the strips in which gradients are turned
  std::array<std::vector<float>, Dim> v, gradient;
  std::vector<float> value(size), inside(size), value_alone(size);
  MappedRow<Dim> row{.row = 0, .begin = 3, .end = static_cast<int>(size)};
  row.start.setConstant(3.2);
  row.step.setConstant(0.02);
  row.step[0] = 0.11;
  std::array<float*, Dim> gradients;
  for (int a = 0; a < Dim; ++a) {
    gradient[a].resize(size);
    gradients[a] = gradient[a].data();
    for (std::size_t i = 0; i < size; ++i) {
      v[a].push_back(0.7f * std::sin(0.3f * static_cast<float>(i) + static_cast<float>(a)));
    }
    row.displacement[a] = v[a].data();
  }
  displaced.evaluate_row(row, value.data(), gradients, inside.data());
  displaced.evaluate_row(row, value_alone.data(), {}, inside.data());
  for (int i = row.begin; i < row.end; ++i) {
    const auto n = static_cast<std::size_t>(i);
    Point<Dim> y = row.start + i * row.step;
    for (int a = 0; a < Dim; ++a) y[a] += static_cast<double>(v[a][n]);
    const auto exact = displaced.evaluate(y);
    EXPECT_NEAR(value[n], exact.value, 1e-5);  // single precision, twice
    EXPECT_EQ(value[n], value_alone[n]);
    for (int a = 0; a < Dim; ++a) EXPECT_NEAR(gradient[a][n], exact.gradient[a], 3e-5);
    EXPECT_EQ(inside[n], exact.inside ? 1.0f : 0.0f);
  }
}

}  // namespace

TEST(DisplacedInterpolator, ReadsTheImageWhereTheDisplacementLeads) {
  expect_composition<2>();
  expect_composition<3>();
}

TEST(DisplacedInterpolator, GradientMatchesCentralDifferences) {
  expect_exact_gradient<2>();
  expect_exact_gradient<3>();
}

TEST(DisplacedInterpolator, RowsAgreeWithPoints) {
  expect_rows_agree_with_points<2>();
  expect_rows_agree_with_points<3>();
}

TEST(DisplacedInterpolator, ValuesStayInTheImagesRange) {
  const Scene<2> scene;
  EXPECT_EQ(scene.displaced().coefficient_range().upper, scene.image->coefficient_range().upper);
  EXPECT_EQ(scene.displaced().raster().size, scene.image->raster().size);
}

TEST(DisplacedInterpolator, RefusesMissingParts) {
  auto displacement = Scene<2>().displacement;
  displacement[1] = nullptr;
  EXPECT_THROW(DisplacedInterpolator<2>(Scene<2>().image, displacement), InvalidInput);
  EXPECT_THROW(DisplacedInterpolator<2>(nullptr, Scene<2>().displacement), InvalidInput);
}

}  // namespace crease

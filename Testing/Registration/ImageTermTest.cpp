#include "Registration/ImageTerm.h"

#include <gtest/gtest.h>

#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Images/MakeInterpolator.h"
#include "Metrics/SumOfSquaredDifferences.h"
#include "Testing/Registration/TestScenes.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

template <int Dim>
struct Setting {
  Raster<Dim> raster = testing::raster_of<Dim>(Dim == 2 ? 70 : 26);
  std::shared_ptr<TensorBSplineBasis<Dim>> basis =
      std::make_shared<TensorBSplineBasis<Dim>>(covering_lattice(raster, Dim == 2 ? 12.0 : 9.0));
  AffineMap<Dim> affine = testing::about_centre<Dim>(raster, 0.94 * Matrix<Dim>::Identity(),
                                                     Vector<Dim>::Constant(0.31));

  std::unique_ptr<ImageTerm<Dim>> term() const {
    MetricInput<Dim> input;
    input.fixed = testing::scene_image<Dim>(raster);
    input.weights.assign(static_cast<std::size_t>(raster.num_samples()), 1.0f);
    // What is mapped out of the moving image has a value but no force: left out.
    for (std::int64_t k = 0; k < raster.num_samples(); ++k) {
      for (int i : input.fixed.index(k)) {
        if (i < 4 || i >= raster.size[0] - 4) input.weights[static_cast<std::size_t>(k)] = 0;
      }
    }
    input.moving = make_interpolator(testing::image_of<Dim>(
        raster, [](const Point<Dim>& x) { return Point<Dim>(x + Vector<Dim>::Constant(0.7)); }));
    return std::make_unique<ImageTerm<Dim>>(
        basis->bind(raster), std::make_shared<SumOfSquaredDifferences<Dim>>(std::move(input)),
        affine);
  }
  ControlPoints<Dim> some_phi(double size) const {
    ControlPoints<Dim> phi(Dim, basis->num_control_points());
    for (Eigen::Index k = 0; k < phi.size(); ++k) {
      phi.data()[k] = size * std::sin(1.3 * static_cast<double>(k));
    }
    return phi;
  }
};

template <typename T>
class ImageTermIn : public ::testing::Test {
 public:
  static constexpr int kDim = T::value;
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(ImageTermIn, Dimensions);

}  // namespace

// Single precision: the value has six digits, so the step is large and the tolerance too. That forces are
// exact derivatives is shown in double precision by the metrics' own tests.
TYPED_TEST(ImageTermIn, GradientMatchesCentralDifferences) {
  constexpr int Dim = TestFixture::kDim;
  const Setting<Dim> setting;
  const auto term = setting.term();
  const ControlPoints<Dim> phi = setting.some_phi(0.6);
  ControlPoints<Dim> gradient = ControlPoints<Dim>::Zero(Dim, phi.cols());
  term->evaluate(phi, 1, &gradient, nullptr);
  ControlPoints<Dim> direction = setting.some_phi(1).reverse();
  const double h = 1e-2;
  const double ahead = term->evaluate(phi + h * direction, 1, nullptr, nullptr);
  const double behind = term->evaluate(phi - h * direction, 1, nullptr, nullptr);
  const double expected = gradient.cwiseProduct(direction).sum();
  EXPECT_NEAR((ahead - behind) / (2 * h), expected, 2e-3 * std::abs(expected));
}

// At zero residual the Gauss-Newton matrix is the Hessian: its quadratic form is the second difference.
TYPED_TEST(ImageTermIn, CurvatureIsTheHessianAtZeroResidual) {
  constexpr int Dim = TestFixture::kDim;
  Setting<Dim> setting;
  MetricInput<Dim> input;
  input.fixed = testing::scene_image<Dim>(setting.raster);
  input.weights.assign(static_cast<std::size_t>(setting.raster.num_samples()), 1.0f);
  input.moving = make_interpolator(input.fixed);
  ImageTerm<Dim> term(setting.basis->bind(setting.raster),
                      std::make_shared<SumOfSquaredDifferences<Dim>>(std::move(input)), {});
  const auto pattern = std::make_shared<HessianPattern>(setting.basis->num_control_points(),
                                                        setting.basis->couplings());
  BlockHessian<Dim> hessian(pattern);
  // A smooth direction, zero near the border, that keeps samples inside: blocks of 4 x 4 (x 4) samples
  // share one basis row.
  ControlPoints<Dim> direction = setting.basis->greville_points();
  const double size = setting.raster.size[0];
  for (Eigen::Index k = 0; k < direction.cols(); ++k) {
    const Point<Dim> x = direction.col(k);
    double bump = 1;
    for (int a = 0; a < Dim; ++a) bump *= std::max(0.0, std::sin(std::numbers::pi * x[a] / size));
    direction.col(k) = Vector<Dim>::Constant(bump);
  }
  const ControlPoints<Dim> zero = ControlPoints<Dim>::Zero(Dim, direction.cols());
  const double at_rest = term.evaluate(zero, 1, nullptr, &hessian);
  const double h = 0.2;
  const double second = (term.evaluate(h * direction, 1, nullptr, nullptr) - 2 * at_rest +
                         term.evaluate(-h * direction, 1, nullptr, nullptr)) /
                        (h * h);
  const Eigen::SparseMatrix<double> lower = hessian.to_sparse();
  const Eigen::VectorXd d = direction.reshaped();
  const Eigen::VectorXd product = lower.template selfadjointView<Eigen::Lower>() * d;
  EXPECT_NEAR(d.dot(product), second, 0.05 * second);
}

TYPED_TEST(ImageTermIn, HasTheSameBytesOnAnyNumberOfThreads) {
  constexpr int Dim = TestFixture::kDim;
  const Setting<Dim> setting;
  const auto pattern = std::make_shared<HessianPattern>(setting.basis->num_control_points(),
                                                        setting.basis->couplings());
  const auto run = [&](int threads) {
    set_num_threads(threads);
    const auto term = setting.term();
    ControlPoints<Dim> gradient =
        ControlPoints<Dim>::Zero(Dim, setting.basis->num_control_points());
    BlockHessian<Dim> hessian(pattern);
    const double value = term->evaluate(setting.some_phi(0.6), 1, &gradient, &hessian);
    set_num_threads(0);
    return std::tuple(value, gradient, Eigen::MatrixXd(hessian.to_sparse()));
  };
  const auto one = run(1);
  for (int threads : {2, 8}) EXPECT_TRUE(one == run(threads)) << threads << " threads";
}

TYPED_TEST(ImageTermIn, LargestStepIsInPixels) {
  constexpr int Dim = TestFixture::kDim;
  const Setting<Dim> setting;
  ControlPoints<Dim> step = ControlPoints<Dim>::Zero(Dim, setting.basis->num_control_points());
  step.row(1).setConstant(-2.5);
  EXPECT_NEAR(setting.term()->largest_step(step), 2.5, 1e-5);
}

TEST(ImageTerm, RefusesAGridOfAnotherRaster) {
  const Setting<2> setting;
  MetricInput<2> input;
  input.fixed = testing::scene_image<2>(testing::raster_of<2>(30));
  input.weights.assign(900, 1.0f);
  input.moving = make_interpolator(input.fixed);
  auto metric = std::make_shared<SumOfSquaredDifferences<2>>(std::move(input));
  EXPECT_THROW(ImageTerm<2>(setting.basis->bind(setting.raster), metric, {}), InvalidInput);
}

}  // namespace crease

#include "Registration/ImageTerm.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Images/MakeInterpolator.h"
#include "Metrics/SumOfSquaredDifferences.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"
#include "Transforms/SplineTransform.h"

namespace crease {
namespace {

template <int Dim>
struct Tensor {
  static constexpr int kDim = Dim;
  static constexpr double kHessianRounding = 1e-10;  // relative to the largest eigenvalue
  static std::shared_ptr<const SplineBasis<Dim>> basis(const Box<Dim>& box) {
    return testing::tensor_over<Dim>(box, Dim == 2 ? 6 : 3, 3);
  }
};
struct Triangles {
  static constexpr int kDim = 2;
  static constexpr double kHessianRounding = 1e-8;  // blocks are summed in single precision
  static std::shared_ptr<const SplineBasis<2>> basis(const Box<2>& box) {
    return testing::triangles_over(box, {.degree = 3}, 5);
  }
};

template <typename Kind>
struct Setting {
  static constexpr int Dim = Kind::kDim;
  Raster<Dim> raster = testing::raster_of<Dim>(Dim == 2 ? 70 : 26);
  std::shared_ptr<const SplineBasis<Dim>> basis = Kind::basis(raster.bounds());
  AffineMap<Dim> affine = testing::about_centre<Dim>(raster, 0.94 * Matrix<Dim>::Identity(),
                                                     Vector<Dim>::Constant(0.31));

  /// The scene, and what it is compared with. What is mapped out of the moving image has a value but no
  /// force: the samples near the border are left out.
  MetricInput<Dim> input(const Image<float, Dim>& moving) const {
    MetricInput<Dim> input;
    input.fixed = testing::scene_image<Dim>(raster);
    input.weights.assign(static_cast<std::size_t>(raster.num_samples()), 1.0f);
    for (std::int64_t k = 0; k < raster.num_samples(); ++k) {
      for (int i : input.fixed.index(k)) {
        if (i < 4 || i >= raster.size[0] - 4) input.weights[static_cast<std::size_t>(k)] = 0;
      }
    }
    input.moving = make_interpolator(moving);
    return input;
  }
  MetricInput<Dim> identical_images() const { return input(testing::scene_image<Dim>(raster)); }
  std::unique_ptr<ImageTerm<Dim>> term() const {
    auto metric = std::make_shared<SumOfSquaredDifferences<Dim>>(input(testing::image_of<Dim>(
        raster, [](const Point<Dim>& x) { return Point<Dim>(x + Vector<Dim>::Constant(0.7)); })));
    return std::make_unique<ImageTerm<Dim>>(basis->bind(raster), std::move(metric), affine);
  }
  BlockHessian<Dim> hessian(ImageTerm<Dim>& term, const ControlPoints<Dim>& phi) const {
    BlockHessian<Dim> hessian(
        std::make_shared<HessianPattern>(basis->num_control_points(), basis->couplings()));
    term.evaluate(phi, 1, nullptr, &hessian);
    return hessian;
  }
  std::vector<Point<Dim>> samples() const {
    std::vector<Point<Dim>> all;
    for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
      for (int i = 0; i < raster.size[0]; ++i) {
        all.push_back(raster.row_start(r) + i * raster.index_to_point().col(0));
      }
    }
    return all;
  }
  ControlPoints<Dim> some_phi(double size) const {
    ControlPoints<Dim> phi(Dim, basis->num_control_points());
    for (Eigen::Index k = 0; k < phi.size(); ++k) {
      phi.data()[k] = size * std::sin(1.3 * static_cast<double>(k));
    }
    return phi;
  }
};

/// Both triangles.
template <int Dim>
Eigen::MatrixXd dense(const BlockHessian<Dim>& hessian) {
  const Eigen::MatrixXd lower = hessian.to_sparse();
  return lower.selfadjointView<Eigen::Lower>();
}

template <typename T>
class ImageTermIn : public ::testing::Test {
 public:
  static constexpr int kDim = T::kDim;
};
using Kinds = ::testing::Types<Tensor<2>, Tensor<3>, Triangles>;
TYPED_TEST_SUITE(ImageTermIn, Kinds);

}  // namespace

// The fused sweep in single precision against sample by sample in double precision, whose gradients are
// checked by differences elsewhere. Intensities of order 1 are interpolated to 2e-6.
TYPED_TEST(ImageTermIn, AgreesWithDoublePrecision) {
  constexpr int Dim = TestFixture::kDim;
  const Setting<TypeParam> setting;
  const auto term = setting.term();
  const ControlPoints<Dim> phi = setting.some_phi(0.6);
  ControlPoints<Dim> gradient = ControlPoints<Dim>::Zero(Dim, phi.cols());
  const double value = term->evaluate(phi, 1, &gradient, nullptr);

  SplineTransform<Dim> transform(setting.basis, setting.affine);
  transform.set_control_points(phi);
  const auto samples = setting.samples();
  std::vector<Point<Dim>> mapped;
  for (const auto& x : samples) mapped.push_back(transform.map(x));
  std::vector<Vector<Dim>> forces(samples.size());
  EXPECT_NEAR(term->metric().evaluate(mapped, forces), value, 1e-6 * value);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(transform.num_parameters());
  transform.add_adjoint(samples, forces, expected);
  EXPECT_LT((gradient.reshaped() - expected).norm(), 1e-5 * expected.norm());
}

/// Compares the matrix at the identity with differences of the gradient in double precision, as far as a
/// matrix of single precision goes.
template <typename Kind, int Dim = Kind::kDim>
void expect_hessian(const Setting<Kind>& setting, MetricInput<Dim> input) {
  const auto metric = std::make_shared<SumOfSquaredDifferences<Dim>>(std::move(input));
  ImageTerm<Dim> term(setting.basis->bind(setting.raster), metric, {});
  const Eigen::MatrixXd H = dense<Dim>(setting.hessian(term, setting.some_phi(0)));

  SplineTransform<Dim> transform(setting.basis);
  const auto samples = setting.samples();
  const Eigen::VectorXd direction = setting.some_phi(1).reshaped();
  const double h = 1e-4;
  Eigen::VectorXd difference = Eigen::VectorXd::Zero(direction.size());
  for (double sign : {1.0, -1.0}) {
    transform.set_parameters(sign * h * direction);
    std::vector<Point<Dim>> mapped;
    for (const auto& x : samples) mapped.push_back(transform.map(x));
    std::vector<Vector<Dim>> forces(samples.size());
    metric->evaluate(mapped, forces);
    for (auto& f : forces) f *= sign / (2 * h);
    transform.add_adjoint(samples, forces, difference);
  }
  EXPECT_LT((H * direction - difference).norm(), 1e-5 * difference.norm());
}

// The matrix sums curvature over blocks of samples, with the basis of one or more of them. Of tensor splines
// it is the middle one: where only that one counts it is the Hessian itself at zero residual.
template <int Dim>
void expect_hessian_of_middle_samples() {
  constexpr int kMiddle = 2;
  const Setting<Tensor<Dim>> setting;
  MetricInput<Dim> input = setting.identical_images();
  for (std::int64_t k = 0; k < setting.raster.num_samples(); ++k) {
    for (int i : input.fixed.index(k)) {
      if (i % 4 != kMiddle) input.weights[static_cast<std::size_t>(k)] = 0;
    }
  }
  expect_hessian(setting, std::move(input));
}

TEST(ImageTerm, CurvatureIsTheHessianAtZeroResidual) {
  expect_hessian_of_middle_samples<2>();
  expect_hessian_of_middle_samples<3>();
}

// Where triangles are narrow every sample's basis counts, with its block's mean curvature: that of each
// sample on a ramp.
TEST(ImageTerm, CurvatureOfNarrowTrianglesIsTheHessianOnARamp) {
  Setting<Triangles> setting;
  setting.basis = testing::triangles_over(setting.raster.bounds(), {.degree = 3}, 12);
  Image<float, 2> ramp(setting.raster);
  for (std::int64_t k = 0; k < setting.raster.num_samples(); ++k) {
    const auto [i, j] = ramp.index(k);
    ramp[{i, j}] = static_cast<float>(i + 2 * j) / 256;
  }
  MetricInput<2> input = setting.input(ramp);
  for (std::int64_t k = 0; k < setting.raster.num_samples(); ++k) {  // whole blocks
    for (int i : ramp.index(k)) {
      if (i < 4 || i >= 64) input.weights[static_cast<std::size_t>(k)] = 0;
    }
  }
  input.fixed = ramp;
  input.moving = make_interpolator(ramp, InterpolationKind::kLinear);
  expect_hessian(setting, std::move(input));
}

// With all samples the blocks are exact for translations, which all functions of a block share, and near
// enough for smooth motions.
TYPED_TEST(ImageTermIn, CurvatureOfAllSamplesIsTheHessianOfTranslations) {
  constexpr int Dim = TestFixture::kDim;
  const Setting<TypeParam> setting;
  const auto metric = std::make_shared<SumOfSquaredDifferences<Dim>>(setting.identical_images());
  ImageTerm<Dim> term(setting.basis->bind(setting.raster), metric, {});
  const Eigen::MatrixXd H = dense<Dim>(setting.hessian(term, setting.some_phi(0)));
  const auto samples = setting.samples();
  const double h = 1e-4;
  for (int a = 0; a < Dim; ++a) {
    Vector<Dim> slope = Vector<Dim>::Zero();
    for (double sign : {1.0, -1.0}) {
      auto mapped = samples;
      for (auto& x : mapped) x[a] += sign * h;
      std::vector<Vector<Dim>> forces(samples.size());
      metric->evaluate(mapped, forces);
      for (const auto& f : forces) slope += sign / (2 * h) * f;
    }
    const auto translation = [&](int b) {
      ControlPoints<Dim> phi = ControlPoints<Dim>::Zero(Dim, setting.basis->num_control_points());
      phi.row(b).setOnes();
      return Eigen::VectorXd(phi.reshaped());
    };
    for (int b = 0; b < Dim; ++b) {
      EXPECT_NEAR(translation(b).dot(H * translation(a)), slope[b], 1e-5 * slope.norm());
    }
  }
}

TYPED_TEST(ImageTermIn, CurvatureIsSymmetricAndPositiveSemiDefinite) {
  constexpr int Dim = TestFixture::kDim;
  const Setting<TypeParam> setting;
  const auto term = setting.term();
  const auto hessian = setting.hessian(*term, setting.some_phi(0.6));
  for (int i = 0; i < hessian.pattern().size(); ++i) {
    const Matrix<Dim>& block = hessian.block(hessian.pattern().slot(i, i));
    EXPECT_LE((block - block.transpose()).norm(), 1e-10 * block.norm());
  }
  const Eigen::VectorXd spectrum =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense<Dim>(hessian), Eigen::EigenvaluesOnly)
          .eigenvalues();
  EXPECT_GT(spectrum[0], -TypeParam::kHessianRounding * spectrum[spectrum.size() - 1]);
}

TYPED_TEST(ImageTermIn, HasTheSameBytesOnAnyNumberOfThreads) {
  constexpr int Dim = TestFixture::kDim;
  const Setting<TypeParam> setting;
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
  const Setting<TypeParam> setting;
  ControlPoints<Dim> step = ControlPoints<Dim>::Zero(Dim, setting.basis->num_control_points());
  step.row(1).setConstant(-2.5);
  EXPECT_NEAR(setting.term()->largest_step(step), 2.5, 1e-5);
}

TEST(ImageTerm, RefusesAGridOfAnotherRaster) {
  const Setting<Triangles> setting;
  MetricInput<2> input;
  input.fixed = testing::scene_image<2>(testing::raster_of<2>(30));
  input.weights.assign(900, 1.0f);
  input.moving = make_interpolator(input.fixed);
  auto metric = std::make_shared<SumOfSquaredDifferences<2>>(std::move(input));
  EXPECT_THROW(ImageTerm<2>(setting.basis->bind(setting.raster), metric, {}), InvalidInput);
}

}  // namespace crease

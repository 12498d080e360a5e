// Registrations whose transform is no spline on a basis with local functions: thin plates, elastic
// bodies, and any other transform through its parameters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Phantoms/Phantom.h"
#include "Registration/Registration.h"
#include "Registration/TransformObjective.h"
#include "Testing/Gradients.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleCentres.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/Splines/CoveringCentres.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Root mean square of the distance to the phantom's truth, mm, away from the border.
double error(const Transform<2>& found, const Phantom& phantom) {
  return testing::rms_difference(
      phantom.fixed.raster(), [&](const Point<2>& x) { return found.map(x); }, phantom.truth, 6);
}

double error_at_rest(const Phantom& phantom) {
  return testing::rms_difference(
      phantom.fixed.raster(), [](const Point<2>& x) { return x; }, phantom.truth, 6);
}

Phantom blobs() { return make_phantom("blobs", {.size = 128, .seed = 3}); }

/// Some landmarks that move as the phantom does.
Landmarks<2> landmarks_of(const Phantom& phantom) {
  Landmarks<2> landmarks;
  landmarks.fixed = {{20, 31}, {64.5, 70}, {101, 33.3}, {50, 110}, {90, 92}};
  for (const auto& p : landmarks.fixed) landmarks.moving.push_back(phantom.truth(p));
  return landmarks;
}

constexpr double kDistance = 16;  // mm between centres

Registration<2> elastic(const Phantom& phantom, const Landmarks<2>& landmarks = {}) {
  Registration<2> registration(phantom.fixed, phantom.moving);
  registration.initial({}).landmarks(landmarks).transform(
      cauchy_navier<2>(phantom.fixed.raster(), kDistance, landmarks.fixed),
      {.detail_mm = kDistance, .roughness = default_roughness_weight<2>(kDistance)});
  return registration;
}

/// The distance between the scene and itself moved and stretched, five pixels from the border on, beyond
/// which the moving image ends.
template <int Dim>
std::shared_ptr<Metric<Dim>> scene_metric(const Raster<Dim>& raster) {
  const auto fixed = testing::image_of<Dim>(raster, [](const Point<Dim>& x) {
    return Point<Dim>(1.03 * x + Vector<Dim>::Constant(0.6));
  });
  MetricInput<Dim> input;
  input.fixed = fixed;
  input.weights.resize(fixed.values().size());
  for (std::size_t k = 0; k < input.weights.size(); ++k) {
    bool inner = true;
    for (const int i : fixed.index(static_cast<std::int64_t>(k))) {
      inner = inner && i >= 5 && i < raster.size[0] - 5;
    }
    input.weights[k] = inner ? 1.0f : 0.0f;
  }
  input.moving = make_interpolator<Dim>(testing::scene_image<Dim>(raster));
  return ssd<Dim>()(std::move(input));
}

}  // namespace

TEST(ThinPlateRegistration, RecoversTheBlobs) {
  const Phantom phantom = blobs();
  const auto basis = covering_thin_plate<2>(phantom.fixed.raster(), kDistance);
  Registration<2> registration(phantom.fixed, phantom.moving);
  registration.initial({}).basis(basis).energy("bending", default_bending_weight(*basis),
                                               bending<2>());
  const auto result = registration.run();
  EXPECT_LT(error(*result.transform, phantom), 0.25 * error_at_rest(phantom));
}

// Balanced against the noise that the images show, roughness weighs less here, and the map is nearer.
TEST(ElasticRegistration, AdaptsTheWeightOfRoughness) {
  const Phantom phantom = blobs();
  const auto fixed_weight = elastic(phantom).run();
  Registration<2> registration = elastic(phantom);
  registration.schedule({.adapt_weights = true});
  const auto result = registration.run();
  EXPECT_LT(result.weights.at("roughness"), 0.5 * fixed_weight.weights.at("roughness"));
  EXPECT_LT(error(*result.transform, phantom), 0.8 * error(*fixed_weight.transform, phantom));
}

TEST(ThinPlateRegistration, MeetsExactLandmarks) {
  const Phantom phantom = blobs();
  Landmarks<2> landmarks = landmarks_of(phantom);
  for (auto& q : landmarks.moving) q += Vector<2>(0.4, -0.3);  // against the images
  const auto basis = covering_thin_plate<2>(phantom.fixed.raster(), kDistance, landmarks.fixed);
  Registration<2> registration(phantom.fixed, phantom.moving);
  registration.initial({}).basis(basis).landmarks(landmarks).energy(
      "bending", default_bending_weight(*basis), bending<2>());
  const auto result = registration.run();
  for (std::size_t j = 0; j < landmarks.fixed.size(); ++j) {
    EXPECT_LT((result.transform->map(landmarks.fixed[j]) - landmarks.moving[j]).norm(),
              1e-9 * phantom.fixed.raster().bounds().diagonal());
  }
  EXPECT_LT(error(*result.transform, phantom), 0.4 * error_at_rest(phantom));
}

TEST(ElasticRegistration, RecoversTheBlobs) {
  const Phantom phantom = blobs();
  const auto result = elastic(phantom).run();
  EXPECT_LT(error(*result.transform, phantom), 0.25 * error_at_rest(phantom));
  EXPECT_LT(result.metric_after, 0.1 * result.metric_before);
  EXPECT_EQ(result.levels.size(), 3u);
  EXPECT_TRUE(result.converged);
  EXPECT_TRUE(result.improved);
  EXPECT_EQ(result.free_parameters, result.transform->num_parameters());
  EXPECT_NE(dynamic_cast<const CauchyNavierTransform<2>*>(result.transform.get()), nullptr);
}

TEST(ElasticRegistration, MeetsExactLandmarksAtCentresAndElsewhere) {
  const Phantom phantom = blobs();
  Landmarks<2> landmarks = landmarks_of(phantom);
  for (auto& q : landmarks.moving) q += Vector<2>(0.4, -0.3);
  const TransformOptions options{.detail_mm = kDistance,
                                 .roughness = default_roughness_weight<2>(kDistance)};
  for (const bool at_centres : {true, false}) {
    Registration<2> registration = elastic(phantom, landmarks);
    if (!at_centres) {
      registration.transform(cauchy_navier<2>(phantom.fixed.raster(), kDistance), options);
    }
    const auto result = registration.run();
    EXPECT_EQ(result.free_parameters, result.transform->num_parameters() - 10);
    for (const double missed : result.landmark_errors_mm) {
      EXPECT_LT(missed, 1e-9 * phantom.fixed.raster().bounds().diagonal());
    }
    EXPECT_LT(error(*result.transform, phantom), 0.4 * error_at_rest(phantom));
  }
}

TEST(ElasticRegistration, SoftLandmarksPull) {
  const Phantom phantom = blobs();
  Landmarks<2> landmarks = landmarks_of(phantom);
  for (auto& q : landmarks.moving) q += Vector<2>(2, -1);
  landmarks.sigma_mm.assign(landmarks.fixed.size(), 0.5);
  const auto missed = [&](double weight) {
    Registration<2> registration = elastic(phantom);
    registration.landmarks(landmarks, {.weight = weight});
    const auto errors = registration.run().landmark_errors_mm;
    return *std::max_element(errors.begin(), errors.end());
  };
  EXPECT_GT(missed(1e-3), 1.5);
  EXPECT_LT(missed(1e4), 0.05);
}

TEST(ElasticRegistration, WorksWithLandmarksAlone) {
  const Phantom phantom = blobs();
  const Landmarks<2> landmarks = landmarks_of(phantom);
  Registration<2> registration;
  registration.landmarks(landmarks).transform(
      cauchy_navier<2>(phantom.fixed.raster(), kDistance, landmarks.fixed),
      {.detail_mm = kDistance, .roughness = 1});
  const auto result = registration.run();
  EXPECT_TRUE(result.converged);
  // The least rough map through the landmarks, whatever else the lattice might have allowed.
  ControlPoints<2> centres(2, 5), shifts(2, 5);
  for (int j = 0; j < 5; ++j) {
    centres.col(j) = landmarks.fixed[j];
    shifts.col(j) = landmarks.moving[j] - landmarks.fixed[j];
  }
  CauchyNavierTransform<2> expected(centres);
  expected.set_parameters(shifts.reshaped());
  for (const Point<2>& x : {Point<2>(10, 10), {64, 64}, {120, 30}}) {
    EXPECT_LT((result.transform->map(x) - expected.map(x)).norm(), 1e-5);
  }
}

TEST(ElasticRegistration, RefusesWhatItCannotDo) {
  const Phantom phantom = make_phantom("blobs", {.size = 64});
  Landmarks<2> landmarks;
  landmarks.fixed = {{20, 31}, {20, 31}};
  landmarks.moving = {{20, 31}, {25, 31}};
  EXPECT_THAT([&] { elastic(phantom, landmarks).run(); },
              ThrowsMessage<InvalidInput>(HasSubstr("share the fixed point")));
  EXPECT_THAT([&] { elastic(phantom).energy("bending", 1, bending<2>()).run(); },
              ThrowsMessage<InvalidInput>(HasSubstr("needs a spline basis")));
  Registration<2> registration(phantom.fixed, phantom.moving);
  const auto rigid = [](const AffineMap<2>& affine) {
    return std::make_unique<RigidTransform<2>>(affine, Point<2>(32, 32));
  };
  EXPECT_THROW(registration.transform(rigid, {.detail_mm = 0}), InvalidInput);
  registration.initial({}).transform(rigid, {.detail_mm = 32, .roughness = 1});
  EXPECT_THAT([&] { registration.run(); },
              ThrowsMessage<InvalidInput>(HasSubstr("knows no roughness")));
  landmarks.fixed[1] = {40, 20};
  registration.transform(rigid, {.detail_mm = 32}).landmarks(landmarks);
  EXPECT_THAT([&] { registration.run(); },
              ThrowsMessage<InvalidInput>(HasSubstr("linear in its parameters")));
}

// A transform that is neither a spline nor linear in its parameters.
TEST(TransformRegistration, TurnsARigidTransform) {
  const auto raster = testing::raster_of<2>(96);
  const auto truth = testing::about_centre<2>(raster, testing::turned<2>(0.1), {2, -1});
  Registration<2> registration(testing::image_of<2>(raster, truth),
                               testing::scene_image<2>(raster));
  registration.initial({}).transform(
      [](const AffineMap<2>& affine) {
        return std::make_unique<RigidTransform<2>>(affine, Point<2>(48, 48));
      },
      {.detail_mm = 48});
  const auto result = registration.run();
  const auto& rigid = dynamic_cast<const RigidTransform<2>&>(*result.transform);
  EXPECT_LT(testing::rms_difference(raster, rigid.affine_map(), truth, 0), 0.05);
}

TEST(TransformRegistration, SameBytesOnAnyNumberOfThreads) {
  const Phantom phantom = make_phantom("blobs", {.size = 64});
  set_num_threads(1);
  const Eigen::VectorXd one = elastic(phantom).run().transform->parameters();
  set_num_threads(3);
  EXPECT_EQ(one, elastic(phantom).run().transform->parameters());
  set_num_threads(0);
}

template <typename Dimension>
class TransformObjectiveOf : public ::testing::Test {
 public:
  static constexpr int kDim = Dimension::value;
  Raster<kDim> raster = testing::raster_of<kDim>(kDim == 2 ? 64 : 24);
  double detail = kDim == 2 ? 16 : 12;
  std::unique_ptr<Transform<kDim>> body() const {
    return std::make_unique<CauchyNavierTransform<kDim>>(
        covering_centres<kDim>(raster, detail, {}));
  }
  TransformObjective<kDim> objective(std::unique_ptr<Transform<kDim>> transform) const {
    return TransformObjective<kDim>(std::move(transform),
                                    std::make_shared<TransformLattice<kDim>>(raster, detail / 4),
                                    scene_metric<kDim>(raster), {}, detail, {});
  }
  static Eigen::VectorXd some_parameters(Eigen::Index size, double largest, unsigned seed) {
    return testing::Numbers(seed).columns<1>(size, largest).transpose();
  }
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(TransformObjectiveOf, Dimensions);

// Through the lattice and in single precision, against every sample in double precision.
TYPED_TEST(TransformObjectiveOf, AgreesWithTheTransformSampleBySample) {
  constexpr int Dim = TestFixture::kDim;
  auto transform = this->body();
  const Eigen::VectorXd p = this->some_parameters(transform->num_parameters(), 0.8, 3);
  transform->set_parameters(p);
  auto objective = this->objective(transform->clone());
  Eigen::VectorXd gradient;
  const double value = objective.evaluate(p, &gradient, nullptr);
  std::vector<Point<Dim>> samples, mapped;
  for (std::int64_t r = 0; r < this->raster.num_rows(); ++r) {
    for (int i = 0; i < this->raster.size[0]; ++i) {
      samples.push_back(this->raster.row_start(r) + i * this->raster.index_to_point().col(0));
      mapped.push_back(transform->map(samples.back()));
    }
  }
  std::vector<Vector<Dim>> forces(samples.size());
  const auto metric = scene_metric<Dim>(this->raster);
  const double expected_value = metric->evaluate(mapped, forces);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(p.size());
  transform->add_adjoint(samples, forces, expected);
  EXPECT_NEAR(value, expected_value, 2e-3 * expected_value);
  EXPECT_LT((gradient - expected).norm(), 5e-3 * expected.norm());
}

TYPED_TEST(TransformObjectiveOf, GradientIsThatOfItsValue) {
  auto transform = this->body();
  const Eigen::VectorXd p = this->some_parameters(transform->num_parameters(), 0.8, 3);
  auto objective = this->objective(std::move(transform));
  Eigen::VectorXd gradient;
  objective.evaluate(p, &gradient, nullptr);
  const Eigen::VectorXd direction = gradient / gradient.cwiseAbs().maxCoeff();
  const auto value = [&](double t) {
    return objective.evaluate(p + t * direction, nullptr, nullptr);
  };
  EXPECT_LT(testing::slope_error(value, gradient.dot(direction), 1e-2), 1e-3);
}

// At a match Gauss-Newton's matrix is the second derivative; gathered in blocks it is near.
TYPED_TEST(TransformObjectiveOf, HessianIsNearTheGradientsSlope) {
  constexpr int Dim = TestFixture::kDim;
  auto transform = this->body();
  const ControlPoints<Dim> centres =
      dynamic_cast<const CauchyNavierTransform<Dim>&>(*transform).centres();
  const ControlPoints<Dim> match = (0.03 * centres).colwise() + Vector<Dim>::Constant(0.6);
  const Eigen::VectorXd p = match.reshaped();
  const Eigen::VectorXd direction = this->some_parameters(p.size(), 1, 5);
  auto objective = this->objective(std::move(transform));
  Eigen::VectorXd gradient, plus, minus;
  Eigen::SparseMatrix<double> lower;
  objective.evaluate(p, &gradient, &lower);
  constexpr double kStep = 0.02;
  objective.evaluate(p + kStep * direction, &plus, nullptr);
  objective.evaluate(p - kStep * direction, &minus, nullptr);
  const Eigen::VectorXd expected = (plus - minus) / (2 * kStep);
  const Eigen::VectorXd found = lower.selfadjointView<Eigen::Lower>() * direction;
  EXPECT_LT((found - expected).norm(), (Dim == 2 ? 0.15 : 0.35) * expected.norm());
  EXPECT_EQ(lower.nonZeros(), p.size() * (p.size() + 1) / 2);
}

TYPED_TEST(TransformObjectiveOf, MeasuresStepsInPixels) {
  constexpr int Dim = TestFixture::kDim;
  auto objective = this->objective(this->body());
  Eigen::VectorXd gradient;
  Eigen::SparseMatrix<double> hessian;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(objective.size());
  objective.evaluate(rest, &gradient, &hessian);
  ControlPoints<Dim> step = ControlPoints<Dim>::Zero(Dim, objective.size() / Dim);
  step.row(0).setConstant(0.7);
  EXPECT_NEAR(objective.step_length(step.reshaped()), 0.7, 1e-6);
}

}  // namespace crease

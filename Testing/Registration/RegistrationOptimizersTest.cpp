// Every optimizer with every metric: better than the start, landmarks exact, the same bytes on any threads;
// and what the preconditioner of a registration is for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Optimizers/Lbfgs.h"
#include "Optimizers/NonlinearConjugateGradient.h"
#include "Registration/CreasedDomain.h"
#include "Registration/ImageLevels.h"
#include "Registration/Phantoms/Phantom.h"
#include "Registration/Registration.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"

namespace crease {
namespace {

struct NamedKind {
  const char* name;
  OptimizerKind kind;
};
const NamedKind kKinds[] = {{"gauss-newton", OptimizerKind::kGaussNewton},
                            {"lbfgs", OptimizerKind::kLbfgs},
                            {"conjugate-gradient", OptimizerKind::kConjugateGradient},
                            {"steepest-descent", OptimizerKind::kSteepestDescent}};

struct NamedMetric {
  const char* name;
  MetricFactory<2> factory;
};
std::vector<NamedMetric> metrics() {
  return {{"ssd", ssd<2>()},
          {"ncc", ncc<2>()},
          {"lncc", local_ncc<2>()},
          {"mi", mutual_information<2>()},
          {"nmi", mutual_information<2>({.kind = InformationKind::kNormalized})}};
}

const Phantom& blobs() {
  static const Phantom phantom = make_phantom("blobs", {.size = 80, .noise = 0.005});
  return phantom;
}

/// True pairs, so that they agree with the images.
Landmarks<2> true_landmarks() {
  Landmarks<2> landmarks;
  landmarks.fixed = {{20, 22}, {60, 30}, {41, 58}};
  for (const auto& p : landmarks.fixed) landmarks.moving.push_back(blobs().truth(p));
  return landmarks;
}

Registration<2> composed(const MetricFactory<2>& metric, OptimizerKind kind, int levels = 2) {
  Registration<2> registration(blobs().fixed, blobs().moving);
  const auto basis = testing::tensor_over<2>(blobs().fixed.raster().bounds(), 5, 3);
  registration.basis(basis)
      .initial({})
      .metric(metric)
      .energy("bending", default_bending_weight(*basis), bending<2>())
      .landmarks(true_landmarks())
      .optimizer(kind)
      .schedule({.levels = levels, .optical_flow = false});
  return registration;
}

double error_of(const RegistrationResult<2>& result) {
  const auto found = [&](const Point<2>& x) { return result.transform->map(x); };
  return testing::rms_difference(blobs().fixed.raster(), found, blobs().truth, 8);
}

/// The cost on a mesh of so many spans, at full resolution.
struct Cost {
  explicit Cost(int spans) {
    const Raster<2>& raster = blobs().fixed.raster();
    const auto basis = testing::tensor_over<2>(raster.bounds(), spans, 3);
    const auto level = image_levels<2>(blobs().fixed, blobs().moving, nullptr, nullptr, 1,
                                       {.smooth_finest = true});
    const std::shared_ptr<Metric<2>> metric = ssd<2>()(metric_input(level[0], level[0].weights));
    const std::shared_ptr<const BoundGrid<2>> grid = basis->bind(raster);
    objective = std::make_unique<RegistrationObjective<2>>(
        basis->pattern(), std::make_shared<ImageTerm<2>>(grid, metric, AffineMap<2>()), 1.0,
        std::vector<WeightedEnergy<2>>{{"bending", 5.0, bending<2>()(*basis, {})}});
  }
  std::unique_ptr<RegistrationObjective<2>> objective;
};

}  // namespace

TEST(RegistrationOptimizers, ImproveEveryMetricAndKeepLandmarks) {
  const double motion = testing::rms_difference(
      blobs().fixed.raster(), [](const Point<2>& x) { return x; }, blobs().truth, 8);
  for (const auto& metric : metrics()) {
    for (const auto& optimizer : kKinds) {
      SCOPED_TRACE(std::string(metric.name) + " by " + optimizer.name);
      const auto result = composed(metric.factory, optimizer.kind).run();
      EXPECT_TRUE(result.improved);
      EXPECT_TRUE(result.converged);
      EXPECT_LT(result.metric_after, result.metric_before);
      EXPECT_LT(error_of(result), 0.6 * motion);
      for (const double error : result.landmark_errors_mm) EXPECT_LT(error, 1e-9 * 80);
    }
  }
}

TEST(RegistrationOptimizers, HaveTheSameBytesOnAnyNumberOfThreads) {
  for (const auto& optimizer : kKinds) {
    for (const auto& metric : {ssd<2>(), mutual_information<2>()}) {
      set_num_threads(1);
      const Eigen::VectorXd one = composed(metric, optimizer.kind).run().transform->parameters();
      for (int threads : {2, 8}) {
        set_num_threads(threads);
        EXPECT_EQ(one, composed(metric, optimizer.kind).run().transform->parameters())
            << optimizer.name;
      }
    }
  }
  set_num_threads(0);
}

TEST(RegistrationOptimizers, ReachTheSameMinimumOfSquaredDifferences) {
  const double reference = error_of(composed(ssd<2>(), OptimizerKind::kGaussNewton).run());
  for (const auto& optimizer : kKinds) {
    EXPECT_NEAR(error_of(composed(ssd<2>(), optimizer.kind).run()), reference, 0.03)
        << optimizer.name;
  }
}

TEST(RegistrationOptimizers, RefuseNelderMeadForSplines) {
  Registration<2> registration;
  EXPECT_THAT([&] { registration.optimizer(OptimizerKind::kNelderMead); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("rigid and affine")));
}

// With the preconditioner the number of iterations does not grow when the mesh is refined.
TEST(RegistrationOptimizers, NeedNoMoreIterationsOnFinerMeshes) {
  const OptimizerOptions stopping{
      .relative_decrease = 0, .relative_gradient = 0, .max_iterations = 400};
  const auto iterations = [&](const Optimizer& optimizer, Cost& cost, double goal) {
    const Eigen::VectorXd start = Eigen::VectorXd::Zero(cost.objective->size());
    return optimizer
        .minimize(*cost.objective, start, nullptr,
                  [&](const IterationRecord& record) { return record.value > goal; })
        .iterations;
  };
  std::vector<int> lbfgs, conjugate, plain;
  for (int spans : {6, 12, 24}) {
    Cost cost(spans);
    const Eigen::VectorXd start = Eigen::VectorXd::Zero(cost.objective->size());
    const auto best = Lbfgs({.relative_decrease = 1e-6}).minimize(*cost.objective, start);
    const double goal = best.value + 1e-3 * (best.initial_value - best.value);
    lbfgs.push_back(iterations(Lbfgs(stopping), cost, goal));
    conjugate.push_back(iterations(NonlinearConjugateGradient(stopping), cost, goal));
    plain.push_back(iterations(Lbfgs(stopping, {.precondition = false}), cost, goal));
  }
  EXPECT_GT(plain[2], 2 * plain[0]) << ::testing::PrintToString(plain);
  EXPECT_LE(lbfgs[2], lbfgs[0] + 4) << ::testing::PrintToString(lbfgs);
  EXPECT_LE(conjugate[2], conjugate[0] + 4) << ::testing::PrintToString(conjugate);
  EXPECT_LT(3 * lbfgs[2], plain[2]) << ::testing::PrintToString(lbfgs);
}

// What it is: one scalar matrix, the mean of Gauss-Newton's two diagonal blocks, and a weak spring.
TEST(RegistrationOptimizers, PreconditionByTheMeanOfTheHessiansBlocks) {
  Cost cost(5);
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(cost.objective->size());
  Eigen::SparseMatrix<double> H, P;
  Eigen::VectorXd gradient;
  cost.objective->evaluate(x, &gradient, &H);
  ASSERT_TRUE(cost.objective->preconditioner(x, P));
  ASSERT_EQ(2 * P.rows(), H.rows());
  const Eigen::MatrixXd full = Eigen::MatrixXd(H).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd scalar = Eigen::MatrixXd(P).selfadjointView<Eigen::Lower>();
  const double scale = scalar.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < scalar.rows(); ++i) {
    for (Eigen::Index k = 0; k < scalar.rows(); ++k) {
      const double mean = 0.5 * (full(2 * i, 2 * k) + full(2 * i + 1, 2 * k + 1));
      EXPECT_NEAR(scalar(i, k), mean, 1e-5 * scale);
    }
  }
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(scalar).info(), Eigen::Success);
}

// Where an energy couples coordinates the matrix does, too.
TEST(RegistrationOptimizers, PreconditionBodiesByTheirWholeHessian) {
  const Box<2> box = blobs().fixed.raster().bounds();
  const auto basis = testing::creased_over(box);
  const auto rigid = rigidity<2>()(*basis, {});
  RegistrationObjective<2> objective(basis->pattern(), nullptr, 0, {{"rigidity", 2.0, rigid}});
  Eigen::SparseMatrix<double> P;
  ASSERT_TRUE(objective.preconditioner(Eigen::VectorXd::Zero(objective.size()), P));
  EXPECT_EQ(P.rows(), objective.size());
}

// A trial step that carries the image away is shortened; a start there is an error.
TEST(RegistrationOptimizers, CountTooLittleOverlapAsInfinite) {
  Cost cost(5);
  const Eigen::VectorXd near = Eigen::VectorXd::Zero(cost.objective->size());
  const Eigen::VectorXd away = Eigen::VectorXd::Constant(near.size(), 500);
  EXPECT_THROW(cost.objective->evaluate(away, nullptr, nullptr), SolverError);
  EXPECT_TRUE(std::isfinite(cost.objective->evaluate(near, nullptr, nullptr)));
  EXPECT_TRUE(std::isinf(cost.objective->evaluate(away, nullptr, nullptr)));
}

TEST(RegistrationOptimizers, RefineRigidAndAffineMaps) {
  const auto raster = testing::raster_of<2>(96);
  const AffineMap<2> truth =
      testing::about_centre<2>(raster, Matrix<2>{{1.03, 0.05}, {-0.06, 0.98}}, {2, -1});
  const auto fixed = testing::image_of<2>(raster, truth);
  const auto moving = testing::scene_image<2>(raster);
  for (auto kind :
       {OptimizerKind::kGaussNewton, OptimizerKind::kLbfgs, OptimizerKind::kConjugateGradient,
        OptimizerKind::kSteepestDescent, OptimizerKind::kNelderMead}) {
    const auto found = align<2>(fixed, moving, nullptr, nullptr, {},
                                {.start = AlignmentStart::kIdentity,
                                 .search = AlignmentSearch::kAffine,
                                 .optimizer = kind});
    EXPECT_LT(testing::rms_difference(raster, found.map, truth, 0), 0.03) << static_cast<int>(kind);
  }
}

}  // namespace crease

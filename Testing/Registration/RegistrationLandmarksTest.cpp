// Exact landmarks in whole registrations, and the minimum that all null spaces and solvers share.
#include <gtest/gtest.h>

#include <algorithm>

#include "Optimizers/GaussNewton.h"
#include "Optimizers/Lbfgs.h"
#include "Optimizers/NonlinearConjugateGradient.h"
#include "Optimizers/SteepestDescent.h"
#include "Registration/Registration.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Energies/DirichletEnergy.h"

namespace crease {
namespace {

constexpr NullSpaceKind kNullSpaces[] = {NullSpaceKind::kElimination, NullSpaceKind::kQr,
                                         NullSpaceKind::kSvd};

template <int Dim>
struct Tensor {
  static constexpr int kDim = Dim, kSize = Dim == 2 ? 64 : 24;
  static std::shared_ptr<const SplineBasis<Dim>> basis(const Box<Dim>& box) {
    return testing::tensor_over<Dim>(box, 3, 3);
  }
};
struct Triangles {
  static constexpr int kDim = 2, kSize = 64;
  static std::shared_ptr<const SplineBasis<2>> basis(const Box<2>& box) {
    return testing::triangles_over(box, {.degree = 3});
  }
};
struct CreasedTriangles {
  static constexpr int kDim = 2, kSize = 64;
  static std::shared_ptr<const SplineBasis<2>> basis(const Box<2>& box) {
    return testing::creased_over(box);
  }
};
using Kinds = ::testing::Types<Tensor<2>, Tensor<3>, Triangles, CreasedTriangles>;

/// Some spread landmarks, one of them at the domain's corner, moved by up to 2 mm.
template <int Dim>
Landmarks<Dim> some_landmarks(const Box<Dim>& box) {
  testing::Numbers numbers(3);
  Landmarks<Dim> landmarks;
  landmarks.fixed.push_back(box.lower);
  for (int j = 0; j < 6; ++j) {
    const Vector<Dim> share = numbers.columns<Dim>(1, 0.45).array() + 0.5;
    landmarks.fixed.push_back(box.lower + share.cwiseProduct(box.size()));
  }
  for (const auto& p : landmarks.fixed) landmarks.moving.push_back(p + numbers.columns<Dim>(1, 2));
  return landmarks;
}

struct Stop {
  OptimizerOptions options;
  bool cancel = false;
  std::vector<StopReason> reasons;
};

const Stop kStops[] = {
    {{.max_iterations = 0}, false, {StopReason::kIterationLimit}},
    {{.max_iterations = 2}, false, {StopReason::kIterationLimit}},
    {{.max_seconds = 0}, false, {StopReason::kTimeLimit}},
    {{}, true, {StopReason::kCancelled}},
    {{.relative_decrease = 1e-3, .small_decreases = 1, .max_iterations = 500},
     false,
     {StopReason::kSmallDecrease, StopReason::kSmallGradient, StopReason::kNoDecrease}}};

}  // namespace

template <typename Kind>
class RegistrationLandmarks : public ::testing::Test {
 public:
  static constexpr int kDim = Kind::kDim;
  Raster<kDim> raster = testing::raster_of<kDim>(Kind::kSize);
  std::shared_ptr<const SplineBasis<kDim>> basis = Kind::basis(raster.bounds());
  Landmarks<kDim> landmarks = some_landmarks<kDim>(raster.bounds());
};
TYPED_TEST_SUITE(RegistrationLandmarks, Kinds);

// T(p_j) = q_j to 1e-9 of the domain's size, whatever the optimizer, the null space and the reason to stop.
TYPED_TEST(RegistrationLandmarks, AreExactAfterAnyStop) {
  constexpr int Dim = TestFixture::kDim;
  const auto fixed = testing::image_of<Dim>(this->raster, [](const Point<Dim>& x) {
    return Point<Dim>(1.02 * x + Vector<Dim>::Constant(0.4));
  });
  const auto moving = testing::scene_image<Dim>(this->raster);
  AffineMap<Dim> affine;
  affine.linear *= 1.03;
  for (const auto kind : kNullSpaces) {
    for (const auto& stop : kStops) {
      const std::shared_ptr<const Optimizer> optimizers[] = {
          std::make_shared<GaussNewton>(stop.options), std::make_shared<Lbfgs>(stop.options),
          std::make_shared<NonlinearConjugateGradient>(stop.options),
          std::make_shared<SteepestDescent>(stop.options)};
      for (const auto& optimizer : optimizers) {
        Registration<Dim> registration(fixed, moving);
        registration.basis(this->basis)
            .initial(affine)
            .energy("bending", 0.1, bending<Dim>())
            .landmarks(this->landmarks)
            .null_space(kind)
            .optimizer(optimizer)
            .schedule({.levels = 1, .optical_flow = false});
        const auto result = registration.run([&](const RegistrationProgress& progress) {
          return !(stop.cancel && progress.stage == "level" && progress.iteration >= 1);
        });
        EXPECT_TRUE(std::ranges::any_of(stop.reasons, [&](StopReason reason) {
          return result.stopped_because == to_string(reason);
        })) << result.stopped_because;
        for (std::size_t j = 0; j < this->landmarks.fixed.size(); ++j) {
          const Point<Dim> found = result.transform->map(this->landmarks.fixed[j]);
          EXPECT_LT((found - this->landmarks.moving[j]).norm(),
                    1e-9 * this->raster.bounds().diagonal())
              << "landmark " << j << ", " << result.stopped_because;
        }
      }
    }
  }
}

// C N = 0, C Phi0 = d, and the span of N is that of the SVD's.
TYPED_TEST(RegistrationLandmarks, NullSpacesMeetTheConstraints) {
  constexpr int Dim = TestFixture::kDim;
  const auto make = [&](NullSpaceKind kind) {
    return make_landmark_constraints<Dim>(this->landmarks, *this->basis, {}, {}, kind).null_space;
  };
  const auto svd = make(NullSpaceKind::kSvd);
  testing::Numbers numbers(7);
  for (const auto kind : kNullSpaces) {
    const auto space = make(kind);
    EXPECT_EQ(space->rank(), this->landmarks.size());
    const auto& [C, d, names] = space->constraints();
    EXPECT_LT((C * space->offset() - d).cwiseAbs().maxCoeff(), 1e-13 * d.cwiseAbs().maxCoeff());
    for (int trial = 0; trial < 10; ++trial) {
      const Eigen::VectorXd step =
          space->apply(numbers.columns<1>(space->reduced_size()).transpose());
      const Eigen::Map<const RowMatrix> phi(step.data(), space->num_rows(), Dim);
      EXPECT_LT((C * phi).cwiseAbs().maxCoeff(), 1e-13 * step.cwiseAbs().maxCoeff());
      const Eigen::VectorXd projected = svd->apply(svd->apply_transpose(step));
      EXPECT_LT((projected - step).norm(), 1e-10 * step.norm());
    }
  }
}

// Landmarks, bending and stretching: a convex problem with one minimum.
TYPED_TEST(RegistrationLandmarks, AllNullSpacesAndSolversFindTheSameMinimum) {
  constexpr int Dim = TestFixture::kDim;
  const EnergyFactory<Dim> stretching = [](const SplineBasis<Dim>& basis, const AffineMap<Dim>&) {
    return std::make_shared<DirichletEnergy<Dim>>(basis);
  };
  double expected = 0;
  for (const auto kind : kNullSpaces) {
    for (const auto solver : {LinearSolver::kDirect, LinearSolver::kPreconditionedCg,
                              LinearSolver::kScalarPreconditionedCg}) {
      Registration<Dim> registration;
      registration.basis(this->basis)
          .energy("bending", 3, bending<Dim>())
          .energy("stretching", 0.02, stretching)
          .landmarks(this->landmarks)
          .null_space(kind)
          .optimizer(std::make_shared<GaussNewton>(
              OptimizerOptions{.relative_decrease = 1e-12, .relative_gradient = 1e-10},
              GaussNewtonOptions{.linear_solver = {.kind = solver}}));
      const auto result = registration.run();
      const double found =
          3 * result.energies.at("bending") + 0.02 * result.energies.at("stretching");
      if (expected == 0) expected = found;
      EXPECT_GT(found, 0);
      EXPECT_NEAR(found, expected, 1e-6 * expected);
    }
  }
}

}  // namespace crease

#include "Registration/LandmarkConstraints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Registration/CreasedDomain.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const auto kBasis =
    std::make_shared<TensorBSplineBasis<2>>(covering_lattice(testing::raster_of<2>(100), 20.0));

Landmarks<2> some_landmarks() {
  Landmarks<2> landmarks;
  landmarks.fixed = {{10, 10}, {80, 15}, {30, 77}, {55, 52}};
  landmarks.moving = {{12, 9}, {83, 17}, {28, 80}, {51, 50}};
  return landmarks;
}

double largest_error(const Landmarks<2>& landmarks, const NullSpace& null_space,
                     const AffineMap<2>& affine) {
  SplineTransform<2> transform(kBasis, affine);
  transform.set_parameters(
      null_space.expand(Eigen::VectorXd::LinSpaced(null_space.reduced_size(), -3, 5)));
  double largest = 0;
  for (std::size_t j = 0; j < landmarks.fixed.size(); ++j) {
    largest = std::max(largest, (transform.map(landmarks.fixed[j]) - landmarks.moving[j]).norm());
  }
  return largest;
}

}  // namespace

TEST(LandmarkConstraints, EveryPointOfTheNullSpaceMeetsThem) {
  AffineMap<2> affine;
  affine.linear << 1.05, 0.1, -0.08, 0.98;
  affine.offset << 3, -2;
  for (auto kind : {NullSpaceKind::kElimination, NullSpaceKind::kQr, NullSpaceKind::kSvd}) {
    const auto constraints =
        make_landmark_constraints<2>(some_landmarks(), *kBasis, affine, {}, kind);
    EXPECT_EQ(constraints.null_space->rank(), 4);
    EXPECT_LT(largest_error(some_landmarks(), *constraints.null_space, affine), 1e-9 * 141);
  }
}

// Landmarks where knot lines meet: on vertices, edges, the border and a crossing of creases. Each row of C
// holds the basis at one of them, which must sum to 1.
TEST(LandmarkConstraints, RowsSumToOneOnKnotLines) {
  const auto box = testing::raster_of<2>(100).bounds();
  const RegionOfInterest region =
      testing::rectangle(box.lower[0], box.lower[1], box.upper[0], box.upper[1]);
  const CreasedDomain domain =
      make_creased_domain(region,
                          {testing::open_line({{20, 20}, {50, 47}, {80, 85}}),
                           testing::open_line({{15, 80}, {52, 50}, {99.5, 30}}),
                           testing::closed_line(testing::regular_polygon({75, 25}, 12, 10))},
                          {.edge_length = 30, .edge_length_near_lines = 12});
  const auto& mesh = domain.mesh.mesh;
  std::vector<Point<2>> places = mesh.vertices;
  for (const auto& s : mesh.simplices) {
    for (double share : {0.1, 0.5}) {
      places.emplace_back((1 - share) * mesh.vertices[s[0]] + share * mesh.vertices[s[1]]);
    }
  }
  for (const auto& cloud : domain.triangular_basis().net().clouds) {
    for (const auto& knot : cloud) {
      if (domain.basis->contains(knot)) places.push_back(knot);
    }
  }
  EXPECT_GT(domain.plan.count(VertexRule::kJunction), 0);
  EXPECT_GT(domain.plan.count(VertexRule::kBorderMeeting), 0);
  for (const auto& p : places) {
    Landmarks<2> one;
    one.fixed = one.moving = {p};
    const auto constraints =
        make_landmark_constraints<2>(one, *domain.basis, {}, {}, NullSpaceKind::kElimination);
    EXPECT_NEAR(constraints.null_space->constraints().C.sum(), 1, 1e-10) << p.transpose();
  }
}

TEST(LandmarkConstraints, SoftLandmarksAreNoConstraints) {
  auto landmarks = some_landmarks();
  landmarks.sigma_mm = {NAN, 2.0, NAN, 0.5};
  EXPECT_THAT(exact_landmarks(landmarks, LandmarkMode::kExact), ::testing::ElementsAre(0, 2));
  EXPECT_THAT(exact_landmarks(landmarks, LandmarkMode::kSoft), ::testing::IsEmpty());
}

TEST(LandmarkConstraints, RepeatedLandmarkIsDroppedWithANote) {
  auto landmarks = some_landmarks();
  landmarks.fixed.push_back(landmarks.fixed[1]);
  landmarks.moving.push_back(landmarks.moving[1]);
  const auto constraints =
      make_landmark_constraints<2>(landmarks, *kBasis, {}, {}, NullSpaceKind::kElimination);
  EXPECT_EQ(constraints.null_space->rank(), 4);
  ASSERT_EQ(constraints.notes.size(), 1u);
  EXPECT_THAT(constraints.notes[0], HasSubstr("follows from"));
}

TEST(LandmarkConstraints, OnePointCannotGoToTwoPlaces) {
  auto landmarks = some_landmarks();
  landmarks.fixed.push_back(landmarks.fixed[1]);
  landmarks.moving.push_back(landmarks.moving[2]);
  EXPECT_THAT(
      [&] {
        make_landmark_constraints<2>(landmarks, *kBasis, {}, {}, NullSpaceKind::kElimination);
      },
      ThrowsMessage<InvalidInput>(AllOf(HasSubstr("landmarks 2 and 5"), HasSubstr("mm apart"))));
}

TEST(LandmarkConstraints, NamesTheDistanceOfALandmarkOutside) {
  auto landmarks = some_landmarks();
  landmarks.fixed[2] = {104.5, 50};
  EXPECT_THAT(
      [&] {
        make_landmark_constraints<2>(landmarks, *kBasis, {}, {}, NullSpaceKind::kElimination);
      },
      ThrowsMessage<InvalidInput>(AllOf(HasSubstr("landmark 3"), HasSubstr("5 mm outside"))));
}

// Ten functions reach into a cubic triangle's core: of twelve landmarks there, two follow from the others.
TEST(LandmarkConstraints, ACubicCoreHoldsTenLandmarks) {
  const auto basis = std::dynamic_pointer_cast<const TriangularBSplineBasis<2>>(
      testing::triangles_over(testing::raster_of<2>(100).bounds(), {.degree = 3}));
  AffineMap<2> affine;
  affine.linear << 1.05, 0.1, -0.08, 0.98;
  constexpr int kTriangle = 12;
  const Point<2> middle = simplex_centroid(basis->net().mesh, kTriangle);
  Landmarks<2> landmarks;
  for (int j = 0; j < 12; ++j) {
    const double angle = 2.4 * j;  // spread by the golden angle
    landmarks.fixed.emplace_back(middle +
                                 std::sqrt(j + 0.5) * Vector<2>(std::cos(angle), std::sin(angle)));
    ASSERT_TRUE(basis->in_core(kTriangle, landmarks.fixed.back()));
    landmarks.moving.push_back(affine(landmarks.fixed.back()));
  }
  for (auto kind : {NullSpaceKind::kElimination, NullSpaceKind::kQr, NullSpaceKind::kSvd}) {
    const auto constraints = make_landmark_constraints<2>(landmarks, *basis, {}, {}, kind);
    EXPECT_EQ(constraints.null_space->rank(), 10);
    EXPECT_EQ(constraints.notes.size(), 2u);
  }
}

// A cubic span has 16 control points: 20 landmarks in it leave at least 4 that cannot be met.
TEST(LandmarkConstraints, ContradictionsAreRefusedOrCompromised) {
  Landmarks<2> landmarks;
  for (int j = 0; j < 20; ++j) {
    const int column = j % 5, row = j / 5;
    const Point<2> p(41 + 3.1 * column, 42 + 4.3 * row);
    landmarks.fixed.push_back(p);
    landmarks.moving.emplace_back(p + Vector<2>(std::sin(5.0 * j), std::cos(7.0 * j)));
  }
  EXPECT_THAT(
      [&] {
        make_landmark_constraints<2>(landmarks, *kBasis, {}, {}, NullSpaceKind::kElimination);
      },
      ThrowsMessage<InvalidInput>(AllOf(HasSubstr("contradict"), HasSubstr("sigma"))));
  const auto compromise = make_landmark_constraints<2>(landmarks, *kBasis, {},
                                                       {.conflict = LandmarkConflict::kCompromise},
                                                       NullSpaceKind::kElimination);
  ASSERT_EQ(compromise.notes.size(), 1u);
  EXPECT_THAT(compromise.notes[0], HasSubstr("least-squares"));
  EXPECT_LT(largest_error(landmarks, *compromise.null_space, {}), 2.0);
}

}  // namespace crease

#include "Registration/LandmarkRefinement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "Core/Error.h"
#include "Registration/LandmarkConstraints.h"
#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Domains/MeshTopology.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::rectangle;
using ::testing::ThrowsMessage;

/// Landmarks at random places of a disc, each moved at random by up to a mm.
Landmarks<2> random_landmarks(int count, const Point<2>& centre, double radius) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Landmarks<2> landmarks;
  while (landmarks.size() < count) {
    const Vector<2> offset(uniform(generator), uniform(generator));
    if (offset.norm() > 1) continue;
    landmarks.fixed.emplace_back(centre + radius * offset);
    landmarks.moving.emplace_back(landmarks.fixed.back() +
                                  Vector<2>(uniform(generator), uniform(generator)));
  }
  return landmarks;
}

const CreasedDomainOptions kCoarse = {.edge_length = 20, .edge_length_near_lines = 20};

}  // namespace

// A cubic patch holds ten landmarks in general position: thirty within one contradict each other.
TEST(LandmarkRefinement, DividesTrianglesUntilAllLandmarksCanBeMet) {
  const auto region = rectangle(0, 0, 100, 100);
  const auto landmarks = random_landmarks(30, {52, 47}, 6);
  const auto coarse = make_creased_domain(region, {}, kCoarse);
  ASSERT_TRUE(find_contradiction(landmarks, *coarse.basis, LandmarkMode::kExact).has_value());

  CreasedDomainOptions options = kCoarse;
  options.landmarks = landmarks;
  const auto domain = make_creased_domain(region, {}, options);
  EXPECT_FALSE(find_contradiction(landmarks, *domain.basis, LandmarkMode::kExact).has_value());
  const auto constraints =
      make_landmark_constraints<2>(landmarks, *domain.basis, {}, {}, NullSpaceKind::kElimination);
  EXPECT_EQ(constraints.null_space->rank(), 30);
  ASSERT_EQ(domain.warnings.size(), 1U);
  EXPECT_THAT(domain.warnings[0], AllOf(HasSubstr("30 exact landmarks"), HasSubstr("divided"),
                                        HasSubstr(" mm became "), HasSubstr("triangles")));
  // Only there: at the corner the edges are what they were.
  const auto figures = mesh_figures(domain.mesh.mesh);
  EXPECT_LT(figures.smallest_edge, 10);
  EXPECT_GT(figures.largest_edge, 15);
}

TEST(LandmarkRefinement, LeavesDomainsAloneThatCanMeetTheirLandmarks) {
  CreasedDomainOptions options = kCoarse;
  const auto before = make_creased_domain(rectangle(0, 0, 100, 100), {}, options);
  options.landmarks = random_landmarks(5, {52, 47}, 30);
  const auto after = make_creased_domain(rectangle(0, 0, 100, 100), {}, options);
  EXPECT_EQ(after.mesh.mesh.vertices, before.mesh.mesh.vertices);
  EXPECT_EQ(after.mesh.mesh.simplices, before.mesh.mesh.simplices);
  EXPECT_TRUE(after.warnings.empty());
}

TEST(LandmarkRefinement, KeepsCreasesOnTheirLines) {
  const auto region = rectangle(0, 0, 100, 100);
  FeatureLine line;
  line.points = {{20, 30}, {80, 30}};
  CreasedDomainOptions options = kCoarse;
  options.landmarks = random_landmarks(30, {52, 30}, 6);
  const auto domain = make_creased_domain(region, {line}, options);
  ASSERT_EQ(domain.mesh.chains.size(), 1U);
  const auto& chain = domain.mesh.chains[0];
  EXPECT_GT(chain.num_edges(), 4);  // divided, 3 edges of 20 mm before
  const MeshTopology topology(domain.mesh.mesh);
  for (int e = 0; e < chain.num_edges(); ++e) {
    EXPECT_GE(topology.edge_between(chain.vertices[e], chain.vertices[e + 1]), 0);
    // A vertex on the line, and all of its knots: the crease is exact.
    for (const auto& knot : domain.triangular_basis().net().clouds[chain.vertices[e]]) {
      if (e > 0) EXPECT_NEAR(knot.y(), 30, 1e-12);
    }
  }
}

TEST(LandmarkRefinement, LandmarksWithASigmaAreNotCounted) {
  CreasedDomainOptions options = kCoarse;
  options.landmarks = random_landmarks(30, {52, 47}, 6);
  options.landmarks.sigma_mm.assign(30, 0.5);
  const auto domain = make_creased_domain(rectangle(0, 0, 100, 100), {}, options);
  EXPECT_TRUE(domain.warnings.empty());
}

// Points a micrometre apart that go to places a millimetre apart are apart for no mesh.
TEST(LandmarkRefinement, GivesUpAfterFourTimesAndSaysWhatItDid) {
  CreasedDomainOptions options = kCoarse;
  options.landmarks = random_landmarks(300, {52, 47}, 0.2);
  EXPECT_THAT([&] { make_creased_domain(rectangle(0, 0, 100, 100), {}, options); },
              ThrowsMessage<InvalidInput>(
                  AllOf(HasSubstr("contradict each other: landmark"), HasSubstr("in triangle"),
                        HasSubstr("divided 4 times"), HasSubstr("compromise"))));
}

TEST(LandmarkRefinement, TwoPlacesForOnePointAreRefusedAtOnce) {
  CreasedDomainOptions options = kCoarse;
  options.landmarks.fixed = {{30, 30}, {60, 40}, {60, 40}};
  options.landmarks.moving = {{31, 30}, {60, 40}, {60, 44}};
  EXPECT_THAT(
      [&] { make_creased_domain(rectangle(0, 0, 100, 100), {}, options); },
      ThrowsMessage<InvalidInput>(AllOf(HasSubstr("landmarks 2 and 3"), HasSubstr("4 mm apart"))));
}

}  // namespace crease

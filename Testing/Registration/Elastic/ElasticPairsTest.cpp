#include "Registration/Elastic/ElasticPairs.h"

#include <gmock/gmock.h>

#include "Testing/Registration/Elastic/ElasticBodies.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Domains/StructuredTriangulation.h"

namespace crease {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

ElasticDeformation good() { return testing::moderate_load(18); }

void expect_refused(const ElasticDeformation& deformation, const std::string& text) {
  EXPECT_THAT([&] { deform_elastically(deformation, {.steps = 1}); },
              ThrowsMessage<InvalidInput>(HasSubstr(text)));
}

/// Pairs crowded into a few millimetres round (30, 0), each with a displacement of its own.
ElasticDeformation crowded(int count) {
  auto deformation = good();
  testing::Numbers numbers(4);
  for (int n = 0; n < count; ++n) {
    const Point<2> p(30 + 3 * numbers(), 3 * numbers());
    deformation.pairs.fixed.push_back(p);
    deformation.pairs.moving.emplace_back(p + Vector<2>(numbers(), numbers()));
  }
  return deformation;
}

/// Two squares with a gap between them.
std::shared_ptr<const TriangularBSplineBasis<2>> two_parts() {
  DomainMesh domain;
  domain.mesh = structured_triangulation(testing::box(0, 0, 10, 10), 2, 2);
  const auto other = structured_triangulation(testing::box(20, 0, 30, 10), 2, 2);
  const int shift = static_cast<int>(domain.mesh.vertices.size());
  domain.mesh.vertices.insert(domain.mesh.vertices.end(), other.vertices.begin(),
                              other.vertices.end());
  for (auto s : other.simplices) {
    for (int& v : s) v += shift;
    domain.mesh.simplices.push_back(s);
  }
  domain.mesh.regions.clear();
  return testing::spline_on(domain, {.degree = 2});
}

}  // namespace

TEST(ElasticPairs, MoveOntoTheBorderWhatLiesJustOutside) {
  auto deformation = good();
  deformation.pairs.fixed[0] = Point<2>(70.8, 0);
  deformation.pairs.moving[0] = Point<2>(72, 0);
  std::swap(deformation.pairs.fixed[0], deformation.pairs.fixed[7]);
  std::swap(deformation.pairs.moving[0], deformation.pairs.moving[7]);
  const auto result = deform_elastically(deformation, {.steps = 2});
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_THAT(result.warnings.front(), HasSubstr("pair 8"));
  EXPECT_THAT(result.warnings.front(), HasSubstr("moved onto its border"));
  Landmarks<2> pairs = deformation.pairs;
  snap_to_domain(pairs, *deformation.basis, 2);
  EXPECT_LT((transform_of(deformation, result).map(pairs.fixed[7]) - pairs.moving[7]).norm(), 1e-7);
}

TEST(ElasticPairs, RefuseWhatLiesFarOutside) {
  auto deformation = good();
  deformation.pairs.fixed[4] = Point<2>(75, 0);
  expect_refused(deformation, "pair 5");
  expect_refused(deformation, "mm outside the domain");
}

TEST(ElasticPairs, FindTheContourAndItsOrder) {
  auto deformation = good();
  auto& pairs = deformation.pairs;
  std::swap(pairs.fixed[2], pairs.fixed[9]);
  std::swap(pairs.moving[2], pairs.moving[9]);
  const auto rows = pairs_along_border(pairs, *deformation.basis, 2);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_THAT(rows[0], ElementsAre(0, 1, 9, 3, 4, 5, 6, 7, 8, 2, 10, 11, 12, 13));
}

TEST(ElasticPairs, RefuseContoursThatCross) {
  auto deformation = good();
  std::swap(deformation.pairs.moving[3], deformation.pairs.moving[8]);
  expect_refused(deformation, "contour pairs cross in the moving image");
  deformation = good();
  std::swap(deformation.pairs.moving[6], deformation.pairs.moving[7]);  // neighbours
  expect_refused(deformation, "from pair 6 to 7 meets that from pair 8 to 9");
  deformation = good();
  deformation.contour = {0, 1, 99};
  expect_refused(deformation, "there is no pair 100");
}

// On a straight contour exchanged neighbours do not cross, but turn back.
TEST(ElasticPairs, RefuseContoursThatTurnBack) {
  Landmarks<2> pairs;
  for (double x : {0.0, 1.0, 2.0, 3.0}) pairs.fixed.emplace_back(x, 0);
  for (double x : {0.0, 2.0, 1.0, 3.0}) pairs.moving.emplace_back(x, 5);
  EXPECT_THAT(
      [&] {
        check_no_crossing(pairs, {0, 1, 2, 3});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("1, 2 and 3 turn back in the moving image")));
  std::swap(pairs.moving[1], pairs.moving[2]);
  EXPECT_NO_THROW(check_no_crossing(pairs, {0, 1, 2, 3}));
}

TEST(ElasticPairs, RefuseBodiesThatFloat) {
  auto deformation = good();
  deformation.pairs.fixed.resize(1);
  deformation.pairs.moving.resize(1);
  expect_refused(deformation, "holds one pair only: it can still float");
  deformation.pairs = {};
  expect_refused(deformation, "holds no pair: it can still float");
  // The same pair twice is one.
  deformation.pairs.fixed = {{20, 0}, {20, 0}};
  deformation.pairs.moving = {{21, 0}, {21, 0}};
  expect_refused(deformation, "holds one pair only");
}

TEST(ElasticPairs, RefuseDomainsOfWhichOnePartFloats) {
  ElasticDeformation deformation;
  deformation.basis = two_parts();
  deformation.pairs.fixed = {{2, 2}, {8, 8}, {5, 2}, {25, 5}};
  deformation.pairs.moving = {{2, 2}, {8, 9}, {5, 2}, {26, 5}};
  expect_refused(deformation, "holds one pair only");
  deformation.pairs.fixed.emplace_back(22, 8);
  deformation.pairs.moving.emplace_back(23, 8);
  EXPECT_EQ(deform_elastically(deformation, {.steps = 2}).fraction, 1);
}

TEST(ElasticPairs, RefuseContradictions) {
  auto deformation = good();
  deformation.pairs.fixed.emplace_back(20, 0);
  deformation.pairs.moving.emplace_back(25, 3);
  expect_refused(deformation, "pairs 15 and 18 share the fixed point");
}

// In the words of elastic bodies: what `crease register` would advise is not to be had.
TEST(ElasticPairs, RefuseMoreThanTheTrianglesCanMeet) {
  EXPECT_THAT([&] { deform_elastically(crowded(40), {.steps = 1}); },
              ThrowsMessage<InvalidInput>(
                  AllOf(HasSubstr("the exact pairs contradict each other: pair "),
                        HasSubstr("delete some of them"), HasSubstr("--mesh-size"),
                        Not(HasSubstr("--landmarks")), Not(HasSubstr("landmark")))));
}

TEST(ElasticPairs, WarnWhereLinearSplinesLock) {
  auto deformation = good();
  deformation.basis = testing::spline_on(testing::half_ellipse(18), {.degree = 1});
  deformation.material.plane = PlaneState::kStrain;
  deformation.material.tissue.poisson = 0.48;
  EXPECT_THAT(deform_elastically(deformation, {.steps = 2}).warnings,
              ::testing::Contains(HasSubstr("lock in plane strain")));
  deformation.material.plane = PlaneState::kStress;
  EXPECT_THAT(deform_elastically(deformation, {.steps = 2}).warnings,
              Not(::testing::Contains(HasSubstr("lock"))));
}

}  // namespace crease

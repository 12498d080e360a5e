// The breast of the mammogram phantom as an elastic body, and phantoms that move like it.
#include "Registration/Phantoms/MammogramBody.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "Core/Parallel.h"
#include "Registration/Phantoms/MammogramOutline.h"
#include "Registration/Phantoms/MammogramStreams.h"
#include "Testing/Registration/MammogramPhantoms.h"

namespace crease {
namespace {

using testing::parameter;
using testing::same_bytes;

const Vector<2> kAcross = Vector<2>(1 / 0.26, 1 / 0.42).normalized();  // out of the muscle
const Vector<2> kAlong = {-kAcross.y(), kAcross.x()};

MammogramMotion motion_of(std::uint64_t seed) {
  return draw_mammogram_motion(mammogram_random(seed, MammogramStream::kMotion));
}

MammogramDeformation truth_of(const MammogramBody& body, std::uint64_t seed) {
  return MammogramDeformation(motion_of(seed), body.follow(motion_of(seed)).further);
}

/// Points on the muscle's edge, some millimetres beyond it, away from its ends.
std::vector<Point<2>> beside_muscle(double distance_mm) {
  std::vector<Point<2>> points;
  const Polyline line = pectoral_line(0, 24);
  for (std::size_t i = 3; i + 3 < line.size(); ++i) {
    points.emplace_back(kMammogramWidthMm * line[i] + distance_mm * kAcross);
  }
  return points;
}

/// Mean of what the derivative along a direction jumps by, from one side of the edge to the other or of a
/// parallel to it.
double mean_jump(const MammogramDeformation& map, double distance_mm, const Vector<2>& direction) {
  constexpr double kBeside = 1e-3;  // mm
  double sum = 0;
  const auto points = beside_muscle(distance_mm);
  for (const Point<2>& x : points) {
    const Matrix<2> jump =
        map.jacobian(x + kBeside * kAcross) - map.jacobian(x - kBeside * kAcross);
    sum += (jump * direction).norm();
  }
  return sum / static_cast<double>(points.size());
}

/// First Piola-Kirchhoff stress on the edge's normal: mu (F - F^-T) + lambda ln J F^-T, plane stress, nu = 0.495.
Vector<2> traction(const Matrix<2>& F, double young) {
  const double nu = 0.495, mu = young / (2 * (1 + nu)), lambda = young * nu / (1 - nu * nu);
  const Matrix<2> inverse_transposed = F.inverse().transpose();
  const Matrix<2> stress =
      mu * (F - inverse_transposed) + lambda * std::log(F.determinant()) * inverse_transposed;
  return stress * kAcross;
}

TEST(MammogramBody, OutsideTheBreastAllMovesAsDrawn) {
  const MammogramBody body({.num_triangles = 2400});
  const MammogramDeformation truth = truth_of(body, 1), drawn(motion_of(1));
  for (const Point<2>& x : {Point<2>(150, 20), Point<2>(195, 190), Point<2>(0, 203)}) {
    EXPECT_EQ(truth(x), drawn(x));
  }
  // On the skin too, whose polygon runs 0.1 mm beside it; there is nothing to tear.
  for (const double theta : skin_angles_by_length(50)) {
    const Point<2> x = kMammogramWidthMm * skin_point(theta);
    EXPECT_LT((truth(x) - drawn(x)).norm(), 0.03);
  }
  EXPECT_GT((truth(Point<2>(40, 60)) - drawn(Point<2>(40, 60))).norm(), 0.3);
}

TEST(MammogramBody, BendsSharplyAtTheMuscleOnly) {
  const MammogramBody body;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const MammogramDeformation truth = truth_of(body, seed);
    const double kink = mean_jump(truth, 0, kAcross);
    EXPECT_GT(kink, 0.08) << seed;
    EXPECT_LT(mean_jump(truth, 0, kAlong), 1e-4);         // continuous
    EXPECT_LT(mean_jump(truth, 8, kAcross), 0.1 * kink);  // what the elements' size leaves
    EXPECT_LT(mean_jump(truth, -8, kAcross), 0.1 * kink);
  }
}

// What makes the kink: forces on the two sides of the edge balance.
TEST(MammogramBody, TractionsBalanceAcrossTheMusclesEdge) {
  const MammogramDeformation truth = truth_of(MammogramBody(), 2);
  double lack = 0, size = 0;
  for (const Point<2>& x : beside_muscle(0)) {
    const Vector<2> muscle = traction(truth.jacobian(x - 1e-3 * kAcross), 10);
    const Vector<2> breast = traction(truth.jacobian(x + 1e-3 * kAcross), 1);
    lack += (muscle - breast).norm();
    size += breast.norm();
  }
  EXPECT_LT(lack, 0.1 * size);  // stresses in elements of 2 mm
}

TEST(MammogramBody, StiffnessDecidesWhereTissueGoes) {
  const MammogramDeformation truth = truth_of(MammogramBody(), 2),
                             uniform = truth_of(MammogramBody({.muscle_stiffness = 1}), 2);
  double sum = 0;
  for (const Point<2>& x : beside_muscle(0)) sum += (truth(x) - uniform(x)).norm();
  EXPECT_GT(sum / static_cast<double>(beside_muscle(0).size()), 1);  // mm
  EXPECT_LT(mean_jump(uniform, 0, kAcross), 0.1 * mean_jump(truth, 0, kAcross));
}

class ElasticMammograms : public ::testing::TestWithParam<MammogramPairKind> {
 protected:
  MammogramPhantomOptions options(std::uint64_t seed) const {
    return {.size = 128, .seed = seed, .pair = GetParam(), .elastic = true};
  }
};

TEST_P(ElasticMammograms, SameSeedSameBytesOnAnyNumberOfThreads) {
  const MammogramPhantom one = make_mammogram_phantom(options(5));
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    EXPECT_TRUE(same_bytes(one, make_mammogram_phantom(options(5)))) << threads << " threads";
  }
  set_num_threads(0);
}

TEST_P(ElasticMammograms, InverseIsConsistent) {
  const auto phantom = make_mammogram_phantom(options(2));
  const double tolerance = 1e-9 * parameter(phantom, "spacing_mm");
  for (int i = 0; i <= 50; ++i) {
    for (int j = 0; j <= 50; ++j) {
      const Point<2> p = kMammogramWidthMm * Point<2>(i / 50.0, j / 50.0);
      EXPECT_LT((phantom.truth(phantom.inverse(p)) - p).norm(), tolerance);
      EXPECT_LT((phantom.inverse(phantom.truth(p)) - p).norm(), tolerance);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothKinds, ElasticMammograms,
                         ::testing::Values(MammogramPairKind::kTemporal,
                                           MammogramPairKind::kBilateral));

TEST(ElasticMammograms, TissueIsNeverSqueezedBelowFourTenths) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto phantom = make_mammogram_phantom({.size = 128, .seed = seed, .elastic = true});
    EXPECT_GT(parameter(phantom, "determinant_min"), 0.4) << seed;
  }
}

// There is no muscle, and none is seen.
TEST(ElasticMammograms, FromAboveTheBodyIsOfOneTissue) {
  const auto phantom =
      make_mammogram_phantom({.size = 128, .seed = 2, .view = MammogramView::kCc, .elastic = true});
  const MammogramDeformation uniform = truth_of(MammogramBody({.muscle = false}), 2);
  for (const Point<2>& x : {Point<2>(20, 60), Point<2>(80, 110)}) {
    EXPECT_LT((phantom.truth(x) - uniform(x)).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace crease

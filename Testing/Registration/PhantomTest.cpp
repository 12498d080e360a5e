#include "Registration/Phantoms/Phantom.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Images/MakeInterpolator.h"
#include "Registration/Phantoms/RoundedPolygon.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

bool same_bytes(const auto& a, const auto& b) {
  return a.values().size() == b.values().size() &&
         (a.values().empty() || std::memcmp(a.values().data(), b.values().data(),
                                            a.values().size() * sizeof(a.values()[0])) == 0);
}

bool same_bytes(const Phantom& a, const Phantom& b) {
  return same_bytes(a.fixed, b.fixed) && same_bytes(a.moving, b.moving) &&
         same_bytes(a.displacement, b.displacement) && same_bytes(a.labels, b.labels) &&
         same_bytes(a.moving_labels, b.moving_labels);
}

PhantomOptions small(std::uint64_t seed = 1) { return {.size = 160, .seed = seed, .noise = 0}; }

double determinant(const Phantom& phantom, const Point<2>& x) {
  const double h = 1e-5;
  const Vector<2> dx = phantom.truth(x + Vector<2>(h, 0)) - phantom.truth(x - Vector<2>(h, 0));
  const Vector<2> dy = phantom.truth(x + Vector<2>(0, h)) - phantom.truth(x - Vector<2>(0, h));
  return (dx.x() * dy.y() - dx.y() * dy.x()) / (4 * h * h);
}

class PhantomKinds : public ::testing::TestWithParam<std::string> {};

// The moving image is band-limited (edges blurred by 1.2 pixels), so its cubic interpolation at
// T(x) must give the fixed image: rms 0.2 %, worst pixel 3 % of the range, at corners of bodies.
TEST_P(PhantomKinds, FixedImageIsTheMovingImageAtTheTruth) {
  for (const std::uint64_t seed : {1, 7}) {
    const Phantom phantom = make_phantom(GetParam(), small(seed));
    const auto moving = make_interpolator<2>(phantom.moving);
    double sum = 0, worst = 0, unregistered = 0;
    int count = 0;
    for (int j = 0; j < 160; ++j) {
      for (int i = 0; i < 160; ++i) {
        const Point<2> y = phantom.truth(Point<2>(i, j));
        if (y.minCoeff() < 2 || y.maxCoeff() > 157) continue;  // away from the border
        const double error = moving->evaluate(y).value - phantom.fixed(i, j);
        sum += error * error;
        unregistered += std::pow(phantom.moving(i, j) - phantom.fixed(i, j), 2);
        worst = std::max(worst, std::abs(error));
        ++count;
      }
    }
    EXPECT_GT(count, 160 * 160 * 3 / 4);
    EXPECT_LT(std::sqrt(sum / count), 0.002);
    EXPECT_LT(worst, 0.03);
    EXPECT_LT(sum, 1e-3 * unregistered);
  }
}

TEST_P(PhantomKinds, DisplacementHoldsTheTruth) {
  const Phantom phantom = make_phantom(GetParam(), small());
  for (const auto& [i, j] : {std::pair{0, 0}, {13, 57}, {80, 80}, {159, 101}}) {
    const Point<2> x(i, j);
    EXPECT_LT((x + phantom.displacement(i, j) - phantom.truth(x)).norm(), 1e-12);
  }
}

TEST_P(PhantomKinds, NothingFoldsForAnySeed) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Phantom phantom = make_phantom(GetParam(), {.size = 80, .seed = seed, .texture = false});
    double smallest = 1;
    for (int j = 0; j < 42; ++j) {
      for (int i = 0; i < 42; ++i) {
        smallest = std::min(smallest, determinant(phantom, {1.87 * i, 1.87 * j}));
      }
    }
    EXPECT_GT(smallest, 0.15) << "seed " << seed;
  }
}

TEST_P(PhantomKinds, SameSeedSameBytesOnAnyNumberOfThreads) {
  PhantomOptions options = small(5);
  options.noise = 0.02;
  const Phantom one = make_phantom(GetParam(), options);
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    EXPECT_TRUE(same_bytes(one, make_phantom(GetParam(), options))) << threads << " threads";
  }
  set_num_threads(0);
}

TEST_P(PhantomKinds, OtherSeedsAreOtherPhantoms) {
  const Phantom a = make_phantom(GetParam(), small(5)), b = make_phantom(GetParam(), small(6));
  EXPECT_FALSE(same_bytes(a.fixed, b.fixed));
  EXPECT_FALSE(same_bytes(a.moving, b.moving));
  EXPECT_FALSE(same_bytes(a.displacement, b.displacement));
}

TEST_P(PhantomKinds, NoiseHasItsDeviationAndIsIndependent) {
  PhantomOptions options = small();
  const Phantom clean = make_phantom(GetParam(), options);
  options.noise = 0.05;
  const Phantom noisy = make_phantom(GetParam(), options);
  double fixed = 0, moving = 0, both = 0;
  const auto n = static_cast<double>(clean.fixed.values().size());
  for (std::size_t i = 0; i < clean.fixed.values().size(); ++i) {
    const double f = noisy.fixed.values()[i] - clean.fixed.values()[i];
    const double m = noisy.moving.values()[i] - clean.moving.values()[i];
    fixed += f * f;
    moving += m * m;
    both += f * m;
  }
  EXPECT_NEAR(std::sqrt(fixed / n), 0.05, 0.001);  // 4.5 standard errors of 25600 samples
  EXPECT_NEAR(std::sqrt(moving / n), 0.05, 0.001);
  EXPECT_LT(std::abs(both / n), 0.05 * 0.05 * 0.03);
}

INSTANTIATE_TEST_SUITE_P(Kinds, PhantomKinds, ::testing::ValuesIn(phantom_kinds()),
                         [](const auto& info) { return info.param; });

TEST(VolumePhantoms, FixedImageIsTheMovingImageAtTheTruth) {
  const VolumePhantom phantom = make_volume_phantom("blobs", {.size = 32, .seed = 3});
  const auto moving = make_interpolator<3>(phantom.moving);
  double sum = 0, unregistered = 0;
  int count = 0;
  const Raster<3>& raster = phantom.fixed.raster();
  for (std::int64_t n = 0; n < raster.num_samples(); ++n) {
    const auto index = phantom.fixed.index(n);
    const Point<3> x(index[0], index[1], index[2]);
    const Point<3> y = phantom.truth(x);
    EXPECT_LT((x + phantom.displacement[index] - y).norm(), 1e-12);
    if (y.minCoeff() < 2 || y.maxCoeff() > 29) continue;  // away from the border
    const double error = moving->evaluate(y).value - phantom.fixed[index];
    sum += error * error;
    unregistered += std::pow(phantom.moving[index] - phantom.fixed[index], 2);
    ++count;
  }
  EXPECT_GT(count, raster.num_samples() / 2);
  EXPECT_LT(std::sqrt(sum / count), 0.004);  // texture and blobs of 1.2 pixels
  EXPECT_LT(sum, 1e-2 * unregistered);
  double largest = 0;
  for (const auto& u : phantom.displacement.values()) largest = std::max(largest, u.norm());
  EXPECT_LE(largest, 0.04 * 32 * (1 + 1e-12));
  EXPECT_GT(largest, 0.5);
}

TEST(VolumePhantoms, SameSeedSameBytesOnAnyNumberOfThreads) {
  const PhantomOptions options = {.size = 24, .seed = 5, .noise = 0.02};
  const VolumePhantom one = make_volume_phantom("blobs", options);
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    const VolumePhantom again = make_volume_phantom("blobs", options);
    EXPECT_TRUE(same_bytes(one.fixed, again.fixed) && same_bytes(one.moving, again.moving));
  }
  set_num_threads(0);
}

TEST(VolumePhantoms, RefusesOtherKindsAndSizes) {
  EXPECT_THAT([] { make_volume_phantom("spine"); },
              ThrowsMessage<InvalidInput>(HasSubstr("in 3D there is blobs")));
  EXPECT_THAT([] { make_volume_phantom("blobs", {.size = 8}); },
              ThrowsMessage<InvalidInput>(HasSubstr("is not in 16 .. 512")));
}

class RigidPhantoms : public ::testing::TestWithParam<std::string> {};

Point<2> moved(const PhantomBody& body, const Point<2>& x) {
  const double c = std::cos(body.angle_deg * std::numbers::pi / 180);
  const double s = std::sin(body.angle_deg * std::numbers::pi / 180);
  const Vector<2> r = x - body.center;
  return body.center + body.shift_mm + Vector<2>(c * r.x() - s * r.y(), s * r.x() + c * r.y());
}

TEST_P(RigidPhantoms, BodiesMoveRigidly) {
  for (const std::uint64_t seed : {1, 9}) {
    const Phantom phantom = make_phantom(GetParam(), small(seed));
    int pixels = 0;
    for (int j = 0; j < 160; ++j) {
      for (int i = 0; i < 160; ++i) {
        const int label = phantom.labels(i, j);
        if (label == 0) continue;
        const Point<2> x(i, j);
        EXPECT_LT((phantom.truth(x) - moved(phantom.bodies[label - 1], x)).norm(), 1e-12 * 160);
        ++pixels;
      }
    }
    EXPECT_GT(pixels, 1000);
  }
}

// The rms distance of the two labellings' borders is below a pixel: labels move with their bodies.
TEST_P(RigidPhantoms, MovingLabelsAreTheMovedBodies) {
  const Phantom phantom = make_phantom(GetParam(), small());
  int wrong = 0, right = 0;
  for (int j = 0; j < 160; ++j) {
    for (int i = 0; i < 160; ++i) {
      const Point<2> y = phantom.truth(Point<2>(i, j));
      const int a = static_cast<int>(std::lround(y.x())), b = static_cast<int>(std::lround(y.y()));
      if (phantom.labels(i, j) == 0 || a < 0 || b < 0 || a >= 160 || b >= 160) continue;
      ++(phantom.moving_labels(a, b) == phantom.labels(i, j) ? right : wrong);
    }
  }
  EXPECT_LT(wrong, 0.06 * right);  // pixels of the border
}

TEST_P(RigidPhantoms, MapIsContinuousAcrossOutlines) {
  const Phantom phantom = make_phantom(GetParam(), small(3));
  for (const auto& line : phantom.feature_lines) {
    for (const auto& p : resample_polyline(line.points, true, 100)) {
      for (const Vector<2>& step : {Vector<2>(1e-7, 3e-8), Vector<2>(-2e-8, 1e-7)}) {
        EXPECT_LT((phantom.truth(p + step) - phantom.truth(p - step)).norm(), 1e-6);
      }
    }
  }
}

TEST_P(RigidPhantoms, OutlinesRunCounterClockwiseRoundTheirLabels) {
  const Phantom phantom = make_phantom(GetParam(), small());
  ASSERT_EQ(phantom.feature_lines.size(), phantom.bodies.size());
  for (std::size_t k = 0; k < phantom.feature_lines.size(); ++k) {
    const auto& line = phantom.feature_lines[k];
    EXPECT_TRUE(line.closed);
    EXPECT_EQ(line.body, BodySide::kLeft);
    EXPECT_GT(signed_area(line.points), 0);
    const auto pixels = std::count(phantom.labels.values().begin(), phantom.labels.values().end(),
                                   static_cast<int>(k) + 1);
    EXPECT_NEAR(pixels, signed_area(line.points), 0.06 * pixels);
  }
}

TEST_P(RigidPhantoms, LandmarksFollowTheTruthExactly) {
  for (const std::uint64_t seed : {1, 4}) {
    const Phantom phantom = make_phantom(GetParam(), small(seed));
    for (int j = 0; j < phantom.landmarks.size(); ++j) {
      EXPECT_LT((phantom.truth(phantom.landmarks.fixed[j]) - phantom.landmarks.moving[j]).norm(),
                1e-9);
    }
    EXPECT_TRUE(phantom.landmarks.sigma_mm.empty());
  }
}

TEST_P(RigidPhantoms, LandmarkNoiseMovesOnlyTheMovingPoints) {
  PhantomOptions options = small();
  const Phantom exact = make_phantom(GetParam(), options);
  options.landmark_noise_mm = 0.5;
  const Phantom noisy = make_phantom(GetParam(), options);
  EXPECT_EQ(noisy.landmarks.fixed, exact.landmarks.fixed);
  EXPECT_TRUE(same_bytes(noisy, exact));
  double sum = 0;
  for (int j = 0; j < exact.landmarks.size(); ++j) {
    sum += (noisy.landmarks.moving[j] - exact.landmarks.moving[j]).squaredNorm();
    EXPECT_EQ(noisy.landmarks.sigma_mm[j], 0.5);
  }
  EXPECT_NEAR(std::sqrt(sum / (2 * exact.landmarks.size())), 0.5, 0.25);
}

INSTANTIATE_TEST_SUITE_P(Kinds, RigidPhantoms, ::testing::Values("square", "bodies", "spine"),
                         [](const auto& info) { return info.param; });

TEST(SquarePhantom, IsExperiment1) {
  const Phantom phantom = make_phantom("square", {.size = 120, .texture = false});
  ASSERT_EQ(phantom.bodies.size(), 1u);
  EXPECT_NEAR(phantom.bodies[0].angle_deg, 45, 1e-12);
  const auto at = [](double x, double y) { return Point<2>(20 * x - 0.5, 20 * y - 0.5); };
  ASSERT_EQ(phantom.landmarks.size(), 8);
  EXPECT_EQ(phantom.landmarks.fixed[0], at(0, 0));
  EXPECT_EQ(phantom.landmarks.moving[0], at(0, 0));
  const double r = std::numbers::sqrt2;
  for (int j = 4; j < 8; ++j) {
    const Vector<2> d = phantom.landmarks.fixed[j] - at(3, 3);
    const Vector<2> turned(Vector<2>(d.x() - d.y(), d.x() + d.y()) / r);
    EXPECT_LT((phantom.landmarks.moving[j] - at(3, 3) - turned).norm(), 1e-12 * 120);
  }
}

TEST(BodiesPhantom, IsExperiment2) {
  const Phantom phantom = make_phantom("bodies", {.size = 80, .texture = false});
  ASSERT_EQ(phantom.bodies.size(), 3u);
  EXPECT_NEAR(phantom.bodies[0].angle_deg, 12, 1e-12);
  EXPECT_NEAR(phantom.bodies[1].angle_deg, -20, 1e-12);
  EXPECT_NEAR(phantom.bodies[2].angle_deg, 15, 1e-12);
  EXPECT_LT((phantom.bodies[0].shift_mm - Vector<2>(3.5, 1.5)).norm(), 1e-12);
  EXPECT_LT((phantom.bodies[1].shift_mm - Vector<2>(2.5, -1)).norm(), 1e-12);
  EXPECT_LT((phantom.bodies[2].shift_mm - Vector<2>(3, 2.5)).norm(), 1e-12);
  EXPECT_EQ(phantom.landmarks.size(), 13);
  // greys deep inside (20 pixels wide) and in the background
  EXPECT_NEAR(phantom.fixed(20, 60), 200 / 255.0, 1e-6);
  EXPECT_NEAR(phantom.fixed(50, 30), 160 / 255.0, 1e-6);
  EXPECT_NEAR(phantom.fixed(15, 15), 120 / 255.0, 1e-3);
  EXPECT_NEAR(phantom.fixed(60, 60), 40 / 255.0, 1e-6);
}

TEST(SpinePhantom, IsExperiment3) {
  const Phantom phantom = make_phantom("spine", {.size = 512, .texture = false});
  ASSERT_EQ(phantom.bodies.size(), 5u);
  EXPECT_EQ(phantom.landmarks.size(), 20);
  for (int i = 0; i < 5; ++i) {
    const auto& body = phantom.bodies[i];
    EXPECT_LT((body.center - Point<2>(256 + 30 * std::sin(0.6 * i), 60 + 95 * i)).norm(), 1e-9);
    EXPECT_NEAR(body.angle_deg, 3 * (i - 2), 1e-12);
    EXPECT_LT((body.shift_mm - Vector<2>(2 * (i - 2) * (i - 2), 4 * (i - 2))).norm(), 1e-12);
    const auto area =
        std::count(phantom.labels.values().begin(), phantom.labels.values().end(), i + 1);
    EXPECT_NEAR(area, 70 * 42 - (4 - std::numbers::pi) * 64, 15);  // rounded corners
  }
}

TEST(BlobsPhantom, MovesByAtMostFourPercent) {
  const Phantom phantom = make_phantom("blobs", {.size = 128, .seed = 11});
  double largest = 0;
  for (const auto& u : phantom.displacement.values()) largest = std::max(largest, u.norm());
  EXPECT_LE(largest, 0.04 * 128 * (1 + 1e-9));
  EXPECT_GT(largest, 0.01 * 128);
  EXPECT_TRUE(phantom.labels.empty());
  EXPECT_TRUE(phantom.landmarks.empty());
}

TEST(RoundedPolygon, DistancesAndOutline) {
  const auto box = RoundedPolygon::rectangle({10, 20}, {70, 42}, 8, 0);
  EXPECT_NEAR(box.signed_distance({10, 20}), -21, 1e-12);
  EXPECT_NEAR(box.signed_distance({10, 45}), 4, 1e-12);
  EXPECT_NEAR(box.signed_distance({45, 41}), 8 * (std::numbers::sqrt2 - 1), 1e-12);
  for (const auto& p : box.outline(3, 5)) EXPECT_NEAR(box.signed_distance(p), 0, 1e-12);
  for (const auto& p : box.corner_points()) EXPECT_NEAR(box.signed_distance(p), 0, 1e-12);
}

TEST(MakePhantom, NamesWhatIsWrong) {
  EXPECT_THAT([] { make_phantom("cube"); },
              ThrowsMessage<InvalidInput>(HasSubstr("square, bodies, spine, blobs")));
  EXPECT_THAT([] { make_phantom("blobs", {.size = 63}); },
              ThrowsMessage<InvalidInput>(HasSubstr("63")));
  EXPECT_THAT([] { make_phantom("blobs", {.noise = -0.1}); },
              ThrowsMessage<InvalidInput>(HasSubstr("-0.1")));
  EXPECT_THAT([] { make_phantom("bodies", {.landmark_noise_mm = std::nan("")}); },
              ThrowsMessage<InvalidInput>(HasSubstr("nan")));
}

}  // namespace
}  // namespace crease

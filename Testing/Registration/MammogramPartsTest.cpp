// The parts of the mammogram phantom: outline, ducts, motion, texture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>

#include "Images/Image.h"
#include "Registration/Phantoms/MammogramDeformation.h"
#include "Registration/Phantoms/MammogramDucts.h"
#include "Registration/Phantoms/MammogramOutline.h"
#include "Registration/Phantoms/MammogramStreams.h"
#include "Registration/Phantoms/MammogramTissue.h"
#include "Registration/Phantoms/PowerLawTexture.h"

namespace crease {
namespace {

constexpr double kPi = std::numbers::pi;

Vector<2> direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

TEST(MammogramOutline, DepthIsZeroOnTheSkin) {
  for (int k = -180; k < 180; ++k) {
    const Point<2> x = skin_point(0.01 * k);
    EXPECT_NEAR(skin_depth(x), 0, 1e-14);
    EXPECT_GT(skin_depth(Point<2>(0, 0.52) + 0.99 * (x - Point<2>(0, 0.52))), 0);
  }
}

TEST(MammogramOutline, NippleStandsOut) {
  const double nipple = skin_radius(kNippleAngle);
  EXPECT_GT(nipple, skin_radius(kNippleAngle - 0.1) + 0.015);
  EXPECT_GT(nipple, skin_radius(kNippleAngle + 0.1) + 0.015);
}

TEST(MammogramOutline, AnglesCutEqualLengths) {
  const auto angles = skin_angles_by_length(40);
  ASSERT_EQ(angles.size(), 40u);
  EXPECT_NEAR(angles.front(), -kPi / 2, 1e-12);
  EXPECT_NEAR(angles.back(), kPi / 2, 1e-9);
  double shortest = 1, longest = 0;
  for (std::size_t k = 1; k < angles.size(); ++k) {
    const double length = polyline_length(skin_line(angles[k - 1], angles[k], 400), false);
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
  }
  EXPECT_LT(longest - shortest, 1e-4 * longest);
}

TEST(MammogramOutline, ThicknessFallsToZeroAtTheSkin) {
  EXPECT_EQ(breast_thickness(-0.1), 0);
  EXPECT_EQ(breast_thickness(0), 0);
  EXPECT_EQ(breast_thickness(0.12), 1);
  EXPECT_EQ(breast_thickness(0.3), 1);
  EXPECT_NEAR(breast_thickness(0.06), std::sqrt(0.75), 1e-14);
}

TEST(MammogramOutline, PectoralLineRunsFromChestWallToSkin) {
  const Polyline line = pectoral_line(0, 20);
  EXPECT_LT((line.front() - Point<2>(0, 0.42)).norm(), 1e-14);
  EXPECT_NEAR(skin_depth(line.back()), 0, 1e-12);
  for (const auto& p : line) EXPECT_NEAR(pectoral_depth(p), 0, 1e-14);
  EXPECT_NEAR(pectoral_depth(Point<2>::Zero()), 0.26 * 0.42 / std::hypot(0.26, 0.42), 1e-14);
}

TEST(Duct, IsAnArc) {
  for (const double turn : {0.7, -0.4, 1e-3, 1e-9, 0.0}) {
    const Duct duct = {.start = {0.4, 0.5}, .angle_rad = 2.5, .turn_rad = turn, .length = 0.1};
    Polyline points;
    for (int i = 0; i <= 2000; ++i) points.push_back(duct.point(i / 2000.0));
    EXPECT_NEAR(polyline_length(points, false), 0.1, 1e-8);
    for (const double share : {0.0, 0.3, 1.0}) {
      const double h = 1e-5;
      const Vector<2> tangent = (duct.point(share + h) - duct.point(share - h)) / (2 * h * 0.1);
      EXPECT_LT((tangent - direction(duct.angle_at(share))).norm(), 1e-8);
    }
    for (const Point<2>& x : {Point<2>(0.37, 0.53), Point<2>(0.45, 0.48), Point<2>(0.3, 0.6)}) {
      EXPECT_NEAR(duct.distance(x), distance_to_polyline(points, false, x), 1e-8);
    }
  }
}

TEST(Ducts, AreFourTreesThatForkThreeTimes) {
  const auto ducts = draw_ducts(3);
  ASSERT_EQ(ducts.size(), 60u);
  std::set<int> numbers;
  int trunks = 0;
  for (const Duct& duct : ducts) {
    numbers.insert(duct.number);
    if (duct.parent < 0) {
      ++trunks;
      EXPECT_EQ(duct.length, 0.11);
      continue;
    }
    const Duct& stem = ducts[duct.parent];
    EXPECT_LT((duct.start - stem.point(1)).norm(), 1e-14);
    const double turned = std::abs(duct.angle_rad - stem.angle_at(1));
    EXPECT_TRUE(turned > 0.45 * 0.7 && turned < 0.75 * 1.1);
    EXPECT_TRUE(duct.length > 0.7 * stem.length && duct.length < 0.95 * stem.length);
    EXPECT_NEAR(duct.width, 0.85 * stem.width, 1e-14);
  }
  EXPECT_EQ(trunks, 4);
  EXPECT_EQ(numbers.size(), 60u);
  EXPECT_EQ(*numbers.rbegin(), 60);
}

TEST(Ducts, TheOtherBreastHasSixtyPercentOfThem) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto own = draw_ducts(seed), other = draw_ducts(seed, true);
    ASSERT_EQ(other.size(), own.size());
    int shared = 0;
    for (const Duct& a : own) {
      for (const Duct& b : other) {
        if (a.number != b.number) continue;
        EXPECT_TRUE(a.start == b.start && a.angle_rad == b.angle_rad && a.length == b.length);
        ++shared;
      }
    }
    EXPECT_EQ(shared, 36);
  }
}

// Along each direction of a fork there is duct, half way between two of them there is none.
TEST(Ducts, ForksPointAlongWhatIsDrawn) {
  const auto ducts = draw_ducts(2);
  const DuctDrawing drawing(ducts, 0.8 / 1024);
  const double step = 12.0 / 1024;
  int branches = 0, clear = 0;
  for (const DuctMark& mark : duct_marks(ducts)) {
    EXPECT_GT(skin_depth(mark.position), 0);
    EXPECT_GT(drawing.coverage(mark.position), 0.85);  // the thinnest ducts are 2.6 pixels wide
    if (mark.crossing) continue;
    ++branches;
    for (const double angle : mark.angles_rad) {
      EXPECT_LE(std::abs(angle), kPi);
      EXPECT_GT(drawing.coverage(mark.position + step * direction(angle)), 0.5) << mark.name;
    }
    const Vector<2> between =
        (direction(mark.angles_rad[1]) + direction(mark.angles_rad[2])).normalized();
    clear += drawing.coverage(mark.position + 1.5 * step * between) < 0.5;
  }
  EXPECT_GE(branches, 20);
  EXPECT_GE(clear, 0.7 * branches);  // other ducts pass by
}

TEST(Ducts, CrossingsLieOnTwoDuctsAndPointAlongThem) {
  constexpr double kStep = 1e-3;  // bends by less than 1e-5
  int crossings = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto ducts = draw_ducts(seed);
    for (const DuctMark& mark : duct_marks(ducts)) {
      if (!mark.crossing) continue;
      ++crossings;
      EXPECT_EQ(mark.angles_rad.size(), 2u);
      std::vector<Duct> here;
      for (const Duct& duct : ducts) {
        if (duct.distance(mark.position) < 1e-5) here.push_back(duct);
      }
      EXPECT_GE(here.size(), 2u) << mark.name;
      for (const double angle : mark.angles_rad) {  // forward or, near a duct's end, backward
        double nearest = 1;
        for (const Duct& duct : here) {
          const Vector<2> ahead = kStep * direction(angle);
          nearest = std::min({nearest, duct.distance(mark.position + ahead),
                              duct.distance(mark.position - ahead)});
        }
        EXPECT_LT(nearest, 2e-5) << mark.name;
      }
    }
  }
  EXPECT_GT(crossings, 10);
}

TEST(MammogramMotion, StaysWithinItsLimits) {
  double largest_angle = 0, largest_amplitude = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto motion = draw_mammogram_motion(mammogram_random(seed, MammogramStream::kMotion));
    EXPECT_LE(std::abs(motion.rotation_rad), 4 * kPi / 180);
    EXPECT_LE(motion.stretch.cwiseAbs().maxCoeff(), 0.06);
    EXPECT_LE(std::abs(motion.shear), 0.06);
    largest_angle = std::max(largest_angle, std::abs(motion.rotation_rad));
    for (const auto& axis : motion.waves) {
      for (const auto& wave : axis) {
        EXPECT_LE(std::abs(wave.amplitude_mm), 0.025 * kMammogramWidthMm);
        EXPECT_GE(kPi / wave.wave_vector.norm(), 0.3 * kMammogramWidthMm * (1 - 1e-12));
        largest_amplitude = std::max(largest_amplitude, wave.amplitude_mm);
      }
    }
  }
  EXPECT_GT(largest_angle, 0.95 * 4 * kPi / 180);
  EXPECT_GT(largest_amplitude, 0.95 * 0.025 * kMammogramWidthMm);
}

TEST(MammogramDeformation, JacobianMatchesCentralDifferences) {
  const MammogramDeformation deformation(
      draw_mammogram_motion(mammogram_random(8, MammogramStream::kMotion)));
  const double h = 1e-4;
  for (const Point<2>& x : {Point<2>(10, 20), Point<2>(90, 110), Point<2>(180, 60)}) {
    for (int a = 0; a < 2; ++a) {
      const Vector<2> step = h * Vector<2>::Unit(a);
      const Vector<2> difference = (deformation(x + step) - deformation(x - step)) / (2 * h);
      EXPECT_LT((deformation.jacobian(x).col(a) - difference).norm(), 1e-8);
    }
  }
}

TEST(MammogramDeformation, ScaledDownItIsTheIdentity) {
  const auto motion = draw_mammogram_motion(mammogram_random(8, MammogramStream::kMotion));
  const MammogramDeformation none(motion.scaled(0));
  const auto [lowest, highest] = none.determinant_range();
  EXPECT_NEAR(lowest, 1, 1e-12);
  EXPECT_NEAR(highest, 1, 1e-12);
  EXPECT_LT((none(Point<2>(50, 70)) - Point<2>(50, 70)).norm(), 1e-12);
}

// Power at the frequencies of a square patch, by the definition of the Fourier transform along rows and then
// along columns; a Hann window keeps the borders from adding power.
std::vector<double> power_spectrum(const Image<float, 2>& image, int left, int top, int n) {
  std::vector<std::complex<double>> roots(n), rows(n * n);
  for (int k = 0; k < n; ++k) roots[k] = std::polar(1.0, -2 * kPi * k / n);
  double mean = 0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) mean += image(left + i, top + j) / (n * n);
  }
  const auto window = [n](int i) { return 0.5 - 0.5 * std::cos(2 * kPi * (i + 0.5) / n); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double value = (image(left + i, top + j) - mean) * window(i) * window(j);
      for (int u = 0; u < n / 2; ++u) rows[j * n + u] += value * roots[u * i % n];
    }
  }
  std::vector<double> power(n / 2 * n);
  for (int u = 0; u < n / 2; ++u) {
    for (int v = 0; v < n; ++v) {
      std::complex<double> sum = 0;
      for (int j = 0; j < n; ++j) sum += rows[j * n + u] * roots[v * j % n];
      power[v * (n / 2) + u] = std::norm(sum);
    }
  }
  return power;
}

// Least-squares slope of ln(mean power on a ring) over ln(frequency), rings from `lower` to `upper` periods.
double power_law_exponent(const std::vector<double>& power, int n, int lower, int upper) {
  std::vector<double> sum(n, 0), count(n, 0);
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u < n / 2; ++u) {
      const auto ring = static_cast<std::size_t>(std::lround(std::hypot(u, v < n / 2 ? v : v - n)));
      sum[ring] += power[v * (n / 2) + u];
      count[ring] += 1;
    }
  }
  double sx = 0, sy = 0, sxx = 0, sxy = 0, m = 0;
  for (int k = lower; k <= upper; ++k) {
    const double x = std::log(k), y = std::log(sum[k] / count[k]),
                 weight = 1.0 / k;  // even in ln f
    m += weight;
    sx += weight * x;
    sy += weight * y;
    sxx += weight * x * x;
    sxy += weight * x * y;
  }
  return -(m * sxy - sx * sy) / (m * sxx - sx * sx);
}

// Mammograms: 2.6 to 3.4 (A. E. Burgess et al., "Human observer detection experiments with mammograms and
// power-law noise", Medical Physics 28, 2001). Ducts are taken away: they are lines, not texture. From
// 0.08 to 0.8 per mm.
TEST(MammogramTissue, TextureFollowsAPowerLawInTheGland) {
  constexpr int kSide = 256, kLeft = 287 - kSide / 2, kTop = 532 - kSide / 2;
  Raster<2> raster;
  raster.size.fill(kSide);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const MammogramTissue tissue({.seed = seed});
    const DuctDrawing ducts(tissue.ducts(), 0.8 / 1024);
    Image<float, 2> image(raster);
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const Point<2> x = Point<2>(kLeft + i, kTop + j) / 1024;
        const double depth = skin_depth(x);
        image(i, j) = static_cast<float>(tissue.grey(x, depth) -
                                         0.10 * breast_thickness(depth) * ducts.coverage(x));
      }
    }
    const double exponent = power_law_exponent(power_spectrum(image, 0, 0, kSide), kSide, 4, 40);
    EXPECT_GT(exponent, 2.6) << "seed " << seed;
    EXPECT_LT(exponent, 3.4) << "seed " << seed;
    RecordProperty("exponent_of_seed_" + std::to_string(seed), std::to_string(exponent));
  }
}

// Where the lowest frequencies are left out, nothing correlates with them.
TEST(PowerLawTexture, LeavesOutLowFrequencies) {
  constexpr int kSize = 64;
  const PowerLawTexture<2> all(kSize, 1.5, 0, Random(3, 1));
  const PowerLawTexture<2> high(kSize, 1.5, 0, Random(3, 1), 1.5 / kSize);
  const auto correlation = [](const PowerLawTexture<2>& texture, double u, double v) {
    std::complex<double> sum = 0;
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) {
        sum += texture({i, j}) * std::polar(1.0, 2 * kPi * (u * i + v * j) / kSize);
      }
    }
    return std::abs(sum) / (kSize * kSize);
  };
  for (const auto& [u, v] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
    EXPECT_LT(correlation(high, u, v), 1e-12);
    EXPECT_GT(correlation(all, u, v), 1e-3);
  }
  EXPECT_GT(correlation(high, 2, 0), 1e-3);
  double sum = 0;
  for (int j = 0; j < kSize; ++j) {
    for (int i = 0; i < kSize; ++i) sum += std::pow(high({i, j}), 2);
  }
  EXPECT_NEAR(sum / (kSize * kSize), 1, 0.2);  // deviation 1
}

}  // namespace
}  // namespace crease

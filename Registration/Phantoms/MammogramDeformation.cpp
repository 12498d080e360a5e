#include "Registration/Phantoms/MammogramDeformation.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Registration/Phantoms/MammogramOutline.h"

namespace crease {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

DisplacementWave draw_wave(Random& random) {
  DisplacementWave wave;
  wave.amplitude_mm = 0.025 * kMammogramWidthMm * random.uniform();
  const double wavelength = 2 * kMammogramWidthMm * random.uniform(0.3, 0.6);
  const double angle = kTwoPi * random.uniform();
  wave.wave_vector = kTwoPi / wavelength * Vector<2>(std::cos(angle), std::sin(angle));
  wave.phase_rad = kTwoPi * random.uniform();
  return wave;
}

struct Range {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
  Range& operator+=(const Range& other) {
    lower = std::min(lower, other.lower);
    upper = std::max(upper, other.upper);
    return *this;
  }
};

}  // namespace

AffineMap<2> MammogramMotion::affine() const {
  const double c = std::cos(rotation_rad), s = std::sin(rotation_rad);
  const Matrix<2> rotation{{c, -s}, {s, c}};
  const Matrix<2> strain{{1 + stretch.x(), shear}, {0, 1 + stretch.y()}};
  AffineMap<2> map;
  map.linear = rotation * strain;
  map.offset = center - map.linear * center;
  return map;
}

MammogramMotion MammogramMotion::scaled(double factor) const {
  MammogramMotion result = *this;
  result.rotation_rad *= factor;
  result.stretch *= factor;
  result.shear *= factor;
  for (auto& axis : result.waves) {
    for (auto& wave : axis) wave.amplitude_mm *= factor;
  }
  return result;
}

MammogramMotion draw_mammogram_motion(Random random) {
  constexpr double kLargestAngle = 4 * std::numbers::pi / 180, kLargestStrain = 0.06;
  MammogramMotion motion;
  motion.rotation_rad = random.uniform(-kLargestAngle, kLargestAngle);
  for (double& s : motion.stretch) s = random.uniform(-kLargestStrain, kLargestStrain);
  motion.shear = random.uniform(-kLargestStrain, kLargestStrain);
  motion.center = kMammogramWidthMm * Point<2>(0.25, 0.52);
  for (auto& axis : motion.waves) {
    for (auto& wave : axis) wave = draw_wave(random);
  }
  return motion;
}

MammogramDeformation::MammogramDeformation(MammogramMotion motion,
                                           std::shared_ptr<const Transform<2>> further)
    : motion_(std::move(motion)), affine_(motion_.affine()), further_(std::move(further)) {}

std::pair<Point<2>, Matrix<2>> MammogramDeformation::sample(const Point<2>& x) const {
  Point<2> y = affine_(x);
  Matrix<2> jacobian = affine_.linear;
  for (int axis = 0; axis < 2; ++axis) {
    for (const DisplacementWave& wave : motion_.waves[axis]) {
      const double argument = wave.wave_vector.dot(x) + wave.phase_rad;
      y[axis] += wave.amplitude_mm * std::sin(argument);
      jacobian.row(axis) += wave.amplitude_mm * std::cos(argument) * wave.wave_vector.transpose();
    }
  }
  if (!further_) return {y, jacobian};
  if (const auto more = further_->sample(x); more.in_domain) {
    y += more.point - x;
    jacobian += more.jacobian - Matrix<2>::Identity();
  }
  return {y, jacobian};
}

Point<2> MammogramDeformation::inverse(const Point<2>& y, const Point<2>& start) const {
  constexpr double kTolerance = 4e-12;
  constexpr int kMaxSteps = 200;
  Point<2> x = start;
  auto here = sample(x);
  for (int i = 0; i < kMaxSteps; ++i) {
    const Vector<2> lack = y - here.first;
    if (lack.norm() < kTolerance) return x;
    Point<2> next = x + here.second.inverse() * lack;
    auto there = sample(next);
    if (!((y - there.first).norm() < lack.norm())) {
      next = x + lack;
      there = sample(next);
    }
    x = next;
    here = there;
  }
  throw SolverError(message("mammogram phantom: the true map has no inverse at (", y.x(), ", ",
                            y.y(), ") mm; its further map folds or tears there"));
}

std::pair<double, double> MammogramDeformation::determinant_range() const {
  constexpr int kCells = 256;
  const auto row = [&](std::int64_t j, Range& range) {
    for (int i = 0; i <= kCells; ++i) {
      const Point<2> x(double(i) / kCells, double(j) / kCells);
      const double det = jacobian(kMammogramWidthMm * x).determinant();
      range += {det, det};
    }
  };
  const Range range = parallel_sum(kCells + 1, Range(), row, 16);
  return {range.lower, range.upper};
}

}  // namespace crease

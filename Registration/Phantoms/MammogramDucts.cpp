#include "Registration/Phantoms/MammogramDucts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "Core/Box.h"
#include "Core/Error.h"
#include "Registration/Phantoms/MammogramOutline.h"
#include "Registration/Phantoms/MammogramStreams.h"

namespace crease {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kTrees = 4, kDuctsPerTree = 15, kNumDucts = kTrees * kDuctsPerTree;
constexpr int kChords =
    32;  // of an arc, where crossings are looked for: off by 0.01 pixels for turns of three deviations

Vector<2> direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

// Adds the branches of ducts[parent], and theirs, `forks` times over. In a tree, duct k forks into 2k and
// 2k + 1.
void grow(std::vector<Duct>& ducts, int parent, int place, int offset, int forks, Random& random) {
  if (forks == 0) return;
  const double half_angle = random.uniform(0.45, 0.75);
  for (const int side : {0, 1}) {
    const Duct stem = ducts[parent];
    Duct duct;
    duct.number = offset + 2 * place + side;
    duct.parent = parent;
    duct.start = stem.point(1);
    const double turned = half_angle * random.uniform(0.7, 1.1);
    duct.angle_rad = stem.angle_at(1) + (side == 0 ? -turned : turned);
    duct.turn_rad = 0.25 * random.normal();
    duct.length = stem.length * random.uniform(0.7, 0.95);
    duct.width = stem.width * 0.85;
    ducts.push_back(duct);
    grow(ducts, static_cast<int>(ducts.size()) - 1, 2 * place + side, offset, forks - 1, random);
  }
}

// Which four of the eight ducts of the second generation bear other ducts in the other breast.
std::vector<bool> draw_changed(std::uint64_t seed) {
  std::vector<bool> changed(2 * kTrees, false);
  Random random = mammogram_random(seed, MammogramStream::kOtherDucts);
  for (int left = kTrees; left > 0;) {
    const auto k = static_cast<std::size_t>(2 * kTrees * random.uniform());
    if (changed[k]) continue;
    changed[k] = true;
    --left;
  }
  return changed;
}

bool visible(const Point<2>& x) { return x.x() >= 0 && skin_depth(x) > 0; }

std::vector<DuctMark> fork_marks(const std::vector<Duct>& ducts) {
  std::vector<DuctMark> marks;
  for (int k = 0; k < std::ssize(ducts); ++k) {
    DuctMark mark = {.name = message("branch ", ducts[k].number),
                     .position = ducts[k].point(1),
                     .angles_rad = {ducts[k].angle_at(1) + kPi}};
    for (const Duct& duct : ducts) {
      if (duct.parent == k) mark.angles_rad.push_back(duct.angle_rad);
    }
    if (mark.angles_rad.size() == 3 && visible(mark.position)) marks.push_back(mark);
  }
  return marks;
}

// Ducts that meet at a fork do not cross there.
bool share_fork(const Duct& a, const Duct& b, const Point<2>& x) {
  constexpr double kSame = 1e-9;
  const auto at_end = [&](const Duct& duct) {
    return (x - duct.start).norm() < kSame || (x - duct.point(1)).norm() < kSame;
  };
  return at_end(a) && at_end(b);
}

void add_crossings(const Duct& a, const Duct& b, std::vector<DuctMark>& marks) {
  constexpr double kStep = 1.0 / kChords;
  for (int i = 0; i < kChords; ++i) {
    for (int j = 0; j < kChords; ++j) {
      const double s = i * kStep, t = j * kStep;
      const auto x =
          segment_crossing(a.point(s), a.point(s + kStep), b.point(t), b.point(t + kStep));
      if (!x || share_fork(a, b, *x) || !visible(*x)) continue;
      marks.push_back({.name = message("crossing ", a.number, "-", b.number),
                       .crossing = true,
                       .position = *x,
                       .angles_rad = {a.angle_at(s + 0.5 * kStep), b.angle_at(t + 0.5 * kStep)}});
      return;  // arcs this short cross once
    }
  }
}

Box<2> box_of(const Duct& duct, double margin) {
  Box<2> box;
  for (int i = 0; i <= kChords; ++i) box.add(duct.point(double(i) / kChords));
  box.lower.array() -= margin;
  box.upper.array() += margin;
  return box;
}

// The bins of a drawing: squares that cover the frame.
constexpr int kBins = 64;

}  // namespace

Point<2> Duct::point(double share) const {
  const double half = 0.5 * share * turn_rad;  // the chord's direction lies half way
  const double sinc = std::abs(half) < 1e-8 ? 1 : std::sin(half) / half;
  return start + share * length * sinc * direction(angle_rad + half);
}

double Duct::distance(const Point<2>& x) const {
  if (std::abs(turn_rad) < 1e-6) {
    return (x - closest_point_on_segment(x, start, point(1))).norm();
  }
  const double radius = length / turn_rad;  // signed: the centre lies on the side it turns to
  const Point<2> center = start + radius * Vector<2>(-std::sin(angle_rad), std::cos(angle_rad));
  const Vector<2> from_center = (x - center) / radius;
  const double swept = std::remainder(
      std::atan2(from_center.y(), from_center.x()) - (angle_rad - 0.5 * kPi), 2 * kPi);
  const double share = swept / turn_rad;
  if (share >= 0 && share <= 1) return std::abs((x - center).norm() - std::abs(radius));
  return std::min((x - start).norm(), (x - point(1)).norm());
}

std::vector<Duct> draw_ducts(std::uint64_t seed, bool other_breast) {
  const Point<2> nipple = skin_point(kNippleAngle);
  const std::vector<bool> changed = draw_changed(seed);
  std::vector<Duct> ducts;
  Random random = mammogram_random(seed, MammogramStream::kDucts);
  for (int tree = 0; tree < kTrees; ++tree) {
    constexpr double kAngles[kTrees] = {-0.55, -0.2, 0.15, 0.5};
    const int offset = kDuctsPerTree * tree;
    const int trunk = static_cast<int>(ducts.size());
    ducts.push_back({.number = offset + 1,
                     .start = nipple - 0.03 * direction(kNippleAngle),
                     .angle_rad = kPi + kAngles[tree],
                     .turn_rad = 0.25 * random.normal(),
                     .length = 0.11,
                     .width = 4.2 / 1024});
    grow(ducts, trunk, 1, offset, 1, random);
    for (const int side : {0, 1}) {
      const int branch = 2 * tree + side;
      const bool other = other_breast && changed[branch];
      Random own = mammogram_random(
          seed, other ? MammogramStream::kOtherBranches : MammogramStream::kBranches, branch);
      grow(ducts, trunk + 1 + side, 2 + side, offset + (other ? kNumDucts : 0), 2, own);
    }
  }
  return ducts;
}

std::vector<DuctMark> duct_marks(const std::vector<Duct>& ducts) {
  std::vector<DuctMark> marks = fork_marks(ducts);
  std::vector<Box<2>> boxes;
  for (const Duct& duct : ducts) boxes.push_back(box_of(duct, 0));
  for (std::size_t a = 0; a < ducts.size(); ++a) {
    for (std::size_t b = a + 1; b < ducts.size(); ++b) {
      if (boxes[a].intersects(boxes[b])) add_crossings(ducts[a], ducts[b], marks);
    }
  }
  for (DuctMark& mark : marks) {
    for (double& angle : mark.angles_rad) angle = std::remainder(angle, 2 * kPi);
  }
  return marks;
}

DuctDrawing::DuctDrawing(std::vector<Duct> ducts, double blur)
    : ducts_(std::move(ducts)), blur_(blur), ducts_of_bin_(kBins * kBins) {
  constexpr double kReach = 5;  // deviations: beyond it a strip covers 3e-7 and less
  for (int k = 0; k < std::ssize(ducts_); ++k) {
    const Box<2> box = box_of(ducts_[k], 0.5 * ducts_[k].width + kReach * blur_);
    const Eigen::Array2d first = (kBins * box.lower.array()).floor().max(0).min(kBins - 1);
    const Eigen::Array2d last = (kBins * box.upper.array()).floor().max(0).min(kBins - 1);
    for (int j = static_cast<int>(first.y()); j <= static_cast<int>(last.y()); ++j) {
      for (int i = static_cast<int>(first.x()); i <= static_cast<int>(last.x()); ++i) {
        ducts_of_bin_[j * kBins + i].push_back(k);
      }
    }
  }
}

int DuctDrawing::bin(const Point<2>& x) {
  if (x.minCoeff() < 0 || x.maxCoeff() >= 1) return -1;
  return static_cast<int>(kBins * x.y()) * kBins + static_cast<int>(kBins * x.x());
}

double DuctDrawing::coverage(const Point<2>& x) const {
  const int here = bin(x);
  if (here < 0) return 0;
  const double scale = 1 / (blur_ * std::numbers::sqrt2);
  double largest = 0;
  for (const int k : ducts_of_bin_[here]) {
    const double half = 0.5 * ducts_[k].width, distance = ducts_[k].distance(x);
    if (distance > half + 5 * blur_) continue;
    const double covered =
        0.5 * (std::erf((half - distance) * scale) + std::erf((half + distance) * scale));
    largest = std::max(largest, covered);
  }
  return largest;
}

}  // namespace crease

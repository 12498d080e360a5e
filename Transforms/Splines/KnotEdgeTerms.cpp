#include "Transforms/Splines/KnotEdgeTerms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "Transforms/Splines/BPatchIndices.h"

namespace crease {
namespace {

constexpr int kMaxKnots = 2 * (kMaxSplineDegree + 1);
constexpr double kSameKnot = 1e-12;  // relative to the edge
constexpr double kNoVolume = 1e-10;  // relative to the set's diameter

using Multiset = std::uint64_t;  // 4 bits per knot: how often it occurs

// Builds the terms of one edge. Knots are numbered 0..n (cloud a) and n+1..2n+1 (cloud b); knots that
// coincide go by the lower number.
class Builder {
 public:
  Builder(KnotEdgeTerms& terms, std::span<const Point<2>> a, std::span<const Point<2>> b,
          int degree)
      : terms_(terms), per_cloud_(degree + 1) {
    const double same = kSameKnot * (b[0] - a[0]).norm();
    for (int cloud = 0; cloud < 2; ++cloud) {
      for (int k = 0; k <= degree; ++k) {
        const int i = cloud * per_cloud_ + k;
        knots_[i] = (cloud == 0 ? a : b)[k] - terms.origin;
        number_[i] = i;
        for (int l = cloud * per_cloud_; l < i && number_[i] == i; ++l) {
          if ((knots_[l] - knots_[i]).norm() <= same) number_[i] = l;
        }
      }
    }
    for (auto& row : line_) row.fill(-1);
    for (int m = 1; m <= degree; ++m) {
      for (int p = 0; p <= m; ++p) values_.push_back(value(prefix(p, m - p)));
    }
    resolve();
  }

 private:
  // What a value number means until all leaves are known: leaves first, then nodes.
  struct Value {
    enum Kind { kZero, kLeaf, kNode } kind = kZero;
    int number = -1;
  };

  Multiset prefix(int p, int q) const {
    Multiset set = 0;
    for (int k = 0; k <= p; ++k) set += Multiset{1} << (4 * number_[k]);
    for (int k = 0; k <= q; ++k) set += Multiset{1} << (4 * number_[per_cloud_ + k]);
    return set;
  }

  double det(int i, int j, int k) const {
    const Vector<2> u = knots_[j] - knots_[i], v = knots_[k] - knots_[i];
    return u[0] * v[1] - u[1] * v[0];
  }

  Value value(Multiset set) {
    for (const auto& [known, v] : known_) {
      if (known == set) return v;
    }
    const Value v = make(set);
    known_.emplace_back(set, v);
    return v;
  }

  Value make(Multiset set) {
    std::array<int, kMaxKnots> distinct;
    int count = 0, total = 0;
    for (int i = 0; i < 2 * per_cloud_; ++i) {
      const int times = static_cast<int>(set >> (4 * i) & 15);
      if (times > 0) distinct[count++] = i;
      total += times;
    }
    double largest = 0.0, diameter = 0.0;
    std::array<int, 3> split{};
    for (int a = 0; a < count; ++a) {
      for (int b = a + 1; b < count; ++b) {
        diameter = std::max(diameter, (knots_[distinct[b]] - knots_[distinct[a]]).squaredNorm());
        for (int c = b + 1; c < count; ++c) {
          const double d = det(distinct[a], distinct[b], distinct[c]);
          if (std::abs(d) <= std::abs(largest)) continue;
          largest = d;
          split = {distinct[a], distinct[b], distinct[c]};
        }
      }
    }
    if (std::abs(largest) < kNoVolume * diameter || largest == 0.0) return {};
    return total == 3 ? make_leaf(split, largest) : make_node(set, split, largest);
  }

  Value make_leaf(const std::array<int, 3>& corner, double determinant) {
    LaneLeaf leaf{1.0 / std::abs(determinant), {}, {}};
    for (int j = 0; j < 3; ++j) {
      const int first = corner[(j + 1) % 3], second = corner[(j + 2) % 3];
      leaf.line[j] = line(std::min(first, second), std::max(first, second));
      // Corner j is left of the line from the next corner to the one after when the leaf is
      // counter-clockwise; the line runs from the lower number to the higher one.
      leaf.sign[j] = (determinant > 0.0) == (first < second) ? 1 : -1;
    }
    terms_.leaves.push_back(leaf);
    return {Value::kLeaf, static_cast<int>(terms_.leaves.size()) - 1};
  }

  int line(int i, int k) {
    if (line_[i][k] < 0) {
      line_[i][k] = static_cast<int>(terms_.pairs.size());
      terms_.pairs.push_back({terms_.origin + knots_[i], terms_.origin + knots_[k]});
    }
    return line_[i][k];
  }

  Value make_node(Multiset set, const std::array<int, 3>& corner, double determinant) {
    LaneNode node;
    std::array<Value, 3> children;
    for (int j = 0; j < 3; ++j) {
      const Point<2>&q = knots_[corner[(j + 1) % 3]], &r = knots_[corner[(j + 2) % 3]];
      node.lambda[3 * j] = (q[1] - r[1]) / determinant;
      node.lambda[3 * j + 1] = (r[0] - q[0]) / determinant;
      node.lambda[3 * j + 2] = (q[0] * r[1] - q[1] * r[0]) / determinant;
      children[j] = value(set - (Multiset{1} << (4 * corner[j])));
    }
    terms_.nodes.push_back(node);
    children_.push_back(children);
    return {Value::kNode, static_cast<int>(terms_.nodes.size()) - 1};
  }

  int resolved(const Value& v) const {
    if (v.kind == Value::kZero) return -1;
    return v.kind == Value::kLeaf ? v.number : v.number + static_cast<int>(terms_.leaves.size());
  }
  void resolve() {
    for (std::size_t i = 0; i < children_.size(); ++i) {
      for (int j = 0; j < 3; ++j) terms_.nodes[i].child[j] = resolved(children_[i][j]);
    }
    for (const Value& v : values_) terms_.slots.push_back(resolved(v));
  }

  KnotEdgeTerms& terms_;
  int per_cloud_;
  std::array<Point<2>, kMaxKnots> knots_;  // relative to the origin
  std::array<int, kMaxKnots> number_{};
  std::array<std::array<int, kMaxKnots>, kMaxKnots> line_{};
  std::vector<std::pair<Multiset, Value>> known_;
  std::vector<std::array<Value, 3>> children_;
  std::vector<Value> values_;  // of E(p, q)
};

}  // namespace

KnotEdgeTerms::KnotEdgeTerms(std::span<const Point<2>> a, std::span<const Point<2>> b, int degree)
    : origin(a[0]) {
  Builder(*this, a, b, degree);
}

}  // namespace crease

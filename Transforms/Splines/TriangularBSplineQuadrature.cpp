#include "Transforms/Splines/TriangularBSplineQuadrature.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "Core/Parallel.h"
#include "Transforms/Splines/KnotCellRule.h"
#include "Transforms/Splines/KnotLocator.h"

namespace crease {
namespace {

constexpr int kLanes = LanePoints::kMaxLanes;
constexpr int kQuantities[3] = {1, 3, 6};

class TriangleElements {
 public:
  TriangleElements(const KnotNet<2>& net, const TriangularBSplineEvaluator& evaluator, int triangle,
                   int derivatives, TriangularBSplineEvaluator::Scratch& scratch)
      : evaluator_(evaluator), triangle_(triangle), derivatives_(derivatives), scratch_(scratch) {
    inside_ = simplex_centroid(net.mesh, triangle);
    region_ = net.mesh.region(triangle);
    size_ = std::sqrt(signed_content<2>(simplex_corners(net.mesh, triangle)));
  }

  std::vector<QuadratureElement<2>> make(std::vector<KnotCell> cells, int degree) {
    std::stable_sort(cells.begin(), cells.end(),
                     [](const KnotCell& a, const KnotCell& b) { return bands(a) < bands(b); });
    std::vector<QuadratureElement<2>> elements;
    CellRule rule;
    for (const KnotCell& cell : cells) {
      set_cell_rule(cell.polygon, degree, rule);
      const int total = static_cast<int>(rule.points.size());
      if (parts_.empty() || used_ + total > kLanes || bands(cell) != bands_) {
        flush(elements);
        bands_ = bands(cell);
      }
      for (int first = 0; first < total; first += kLanes) {
        if (first > 0) flush(elements);
        add_points(cell, rule, first, std::min(total - first, kLanes));
      }
    }
    flush(elements);
    return elements;
  }

 private:
  // Lanes first .. first + count - 1 hold points of one cell, where functions vanish or not as a whole.
  struct Part {
    int first, count;
  };

  static int bands(const KnotCell& cell) { return 2 * cell.in_band + cell.in_two_sided_band; }

  void add_points(const KnotCell& cell, const CellRule& rule, int first, int count) {
    parts_.push_back({used_, count});
    for (int i = first; i < first + count; ++i, ++used_) {
      lanes_.x[used_] = rule.points[i].x();
      lanes_.y[used_] = rule.points[i].y();
      lanes_.side_x[used_] = cell.centroid.x();
      lanes_.side_y[used_] = cell.centroid.y();
      weights_[used_] = rule.weights[i];
    }
  }

  // Makes one element of the lanes filled so far.
  void flush(std::vector<QuadratureElement<2>>& elements) {
    if (used_ == 0) return;
    fill_lanes(lanes_, used_);
    std::fill(lanes_.inside_x, lanes_.inside_x + kLanes, inside_.x());
    std::fill(lanes_.inside_y, lanes_.inside_y + kLanes, inside_.y());
    evaluator_.evaluate(lanes_, {&triangle_, 1}, derivatives_, scratch_);
    choose_functions();
    elements.push_back(element());
    parts_.clear();
    used_ = 0;
  }

  // Whether function f is nothing but rounding in a cell.
  bool vanishes(int f, const Part& part) const {
    constexpr double kZero = 1e-13;
    double unit = 1.0;
    for (int quantity = 0; quantity < kQuantities[derivatives_]; ++quantity) {
      if (quantity == 1 || quantity == 3) unit *= size_;
      const double* lane = scratch_.lanes(f, quantity) + part.first;
      for (int p = 0; p < part.count; ++p) {
        if (unit * std::abs(lane[p]) >= kZero) return false;
      }
    }
    return true;
  }

  // The functions that do not vanish in all cells, by control point, and the cells where they do not.
  void choose_functions() {
    const auto found = scratch_.control_points();
    chosen_.clear();
    for (int f = 0; f < std::ssize(found); ++f) {
      std::uint32_t present = 0;
      for (std::size_t p = 0; p < parts_.size(); ++p) present |= !vanishes(f, parts_[p]) << p;
      if (present != 0) chosen_.push_back({found[f], f, present});
    }
    std::sort(chosen_.begin(), chosen_.end(),
              [](const Chosen& a, const Chosen& b) { return a.control_point < b.control_point; });
  }

  QuadratureElement<2> element() const {
    QuadratureElement<2> e;
    e.region = region_;
    e.patch = triangle_;
    e.in_band = bands_ >= 2;
    e.in_two_sided_band = bands_ % 2 == 1;
    e.points.resize(2, used_);
    for (int p = 0; p < used_; ++p) e.points.col(p) = Point<2>(lanes_.x[p], lanes_.y[p]);
    e.weights = Eigen::Map<const Eigen::VectorXd>(weights_, used_);
    e.control_points.reserve(chosen_.size());
    for (const Chosen& c : chosen_) e.control_points.push_back(c.control_point);
    e.values = quantity(0);
    for (int d = 1; d < kQuantities[derivatives_]; ++d) {
      (d < 3 ? e.gradients : e.hessians).push_back(quantity(d));
    }
    return e;
  }

  // Functions by points, exactly zero where a function vanishes.
  Eigen::MatrixXd quantity(int number) const {
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(std::ssize(chosen_), used_);
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      const double* lane = scratch_.lanes(chosen_[i].function, number);
      for (std::size_t p = 0; p < parts_.size(); ++p) {
        if ((chosen_[i].present >> p & 1) == 0) continue;
        for (int l = parts_[p].first; l < parts_[p].first + parts_[p].count; ++l) {
          values(i, l) = lane[l];
        }
      }
    }
    return values;
  }

  struct Chosen {
    int control_point, function;
    std::uint32_t present;  // a bit per part
  };

  const TriangularBSplineEvaluator& evaluator_;
  const int triangle_;
  const int derivatives_;
  TriangularBSplineEvaluator::Scratch& scratch_;
  Point<2> inside_;
  int region_ = 0;
  double size_ = 1.0;
  LanePoints lanes_;
  double weights_[kLanes];
  int used_ = 0;
  int bands_ = 0;
  std::vector<Part> parts_;
  std::vector<Chosen> chosen_;
};

// A matrix with its rows in another order.
Eigen::MatrixXd reordered(const Eigen::MatrixXd& m, const std::vector<int>& order) {
  return m(order, Eigen::all);
}

// One element for a congruent triangle: points shifted, control points exchanged.
QuadratureElement<2> moved_element(const QuadratureElement<2>& from, const Vector<2>& shift,
                                   const std::vector<int>& control_points) {
  QuadratureElement<2> e = from;
  e.points.colwise() += shift;
  std::vector<int> order(control_points.size());
  std::iota(order.begin(), order.end(), 0);
  if (!std::is_sorted(control_points.begin(), control_points.end())) {
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return control_points[a] < control_points[b]; });
    e.values = reordered(from.values, order);
    for (std::size_t a = 0; a < e.gradients.size(); ++a) {
      e.gradients[a] = reordered(from.gradients[a], order);
    }
    for (std::size_t a = 0; a < e.hessians.size(); ++a) {
      e.hessians[a] = reordered(from.hessians[a], order);
    }
  }
  for (std::size_t i = 0; i < order.size(); ++i) e.control_points[i] = control_points[order[i]];
  return e;
}

}  // namespace

TriangularBSplineQuadrature::TriangularBSplineQuadrature(
    const KnotNet<2>& net, const KnotControlPoints<2>& control_points,
    const TriangularBSplineEvaluator& evaluator)
    : net_(net),
      control_points_(control_points),
      evaluator_(evaluator),
      cells_(net),
      congruence_(net) {}

std::vector<QuadratureElement<2>> TriangularBSplineQuadrature::of_triangle(int triangle,
                                                                           int polynomial_degree,
                                                                           int derivatives) const {
  thread_local TriangularBSplineEvaluator::Scratch scratch;
  return TriangleElements(net_, evaluator_, triangle, derivatives, scratch)
      .make(cells_.of_triangle(triangle), polynomial_degree);
}

// Bands belong to their edges: triangles that meet any are computed on their own.
bool TriangularBSplineQuadrature::movable(int triangle) const {
  const int kind = congruence_.representative(triangle);
  return kind != triangle && !cells_.meets_band(triangle) && !cells_.meets_band(kind);
}

// The elements of a triangle's representative, moved to it; false when control points do not match.
bool TriangularBSplineQuadrature::move(const Elements& from, int triangle,
                                       Elements& elements) const {
  const int kind = congruence_.representative(triangle);
  const auto sources = congruence_.neighbours(kind), targets = congruence_.neighbours(triangle);
  std::unordered_map<int, int> target_of;
  for (std::size_t n = 0; n < sources.size(); ++n) {
    const auto source = control_points_.of_simplex(sources[n]);
    const auto target = control_points_.of_simplex(targets[n]);
    for (std::size_t b = 0; b < source.size(); ++b) {
      if (target_of.try_emplace(source[b], target[b]).first->second != target[b]) return false;
    }
  }
  const auto corner = [&](int t) { return net_.mesh.vertices[net_.mesh.simplices[t][0]]; };
  const Vector<2> shift = corner(triangle) - corner(kind);
  std::vector<int> control_points;
  elements.reserve(from.size());
  for (const auto& element : from) {
    control_points.clear();
    for (int point : element.control_points) control_points.push_back(target_of.at(point));
    elements.push_back(moved_element(element, shift, control_points));
    elements.back().patch = triangle;
    elements.back().region = net_.mesh.region(triangle);
  }
  return true;
}

std::vector<QuadratureElement<2>> TriangularBSplineQuadrature::elements(
    std::span<const int> triangles, int polynomial_degree, int derivatives) const {
  std::vector<int> kinds;  // representatives of those that are moved
  for (int t : triangles) {
    if (movable(t)) kinds.push_back(congruence_.representative(t));
  }
  std::sort(kinds.begin(), kinds.end());
  kinds.erase(std::unique(kinds.begin(), kinds.end()), kinds.end());
  std::vector<Elements> of_kind(kinds.size());
  parallel_for(std::ssize(kinds), [&](std::int64_t k) {
    of_kind[k] = of_triangle(kinds[k], polynomial_degree, derivatives);
  });

  std::vector<Elements> parts(triangles.size());
  parallel_for(std::ssize(triangles), [&](std::int64_t i) {
    const int t = triangles[i];
    const int kind = congruence_.representative(t);
    const auto place = std::lower_bound(kinds.begin(), kinds.end(), kind);
    const bool known = place != kinds.end() && *place == kind && (t == kind || movable(t));
    if (known && move(of_kind[place - kinds.begin()], t, parts[i])) return;
    parts[i] = of_triangle(t, polynomial_degree, derivatives);
  });
  std::vector<QuadratureElement<2>> all;
  std::size_t total = 0;
  for (const auto& part : parts) total += part.size();
  all.reserve(total);
  for (auto& part : parts) {
    all.insert(all.end(), std::make_move_iterator(part.begin()),
               std::make_move_iterator(part.end()));
  }
  return all;
}

}  // namespace crease

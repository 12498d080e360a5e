#include "Transforms/Splines/TriangularBSplineQuadrature.h"

#include <algorithm>
#include <cmath>
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

  std::vector<QuadratureElement<2>> make(const std::vector<KnotCell>& cells, int degree) {
    std::vector<QuadratureElement<2>> elements;
    elements.reserve(cells.size());
    CellRule rule;
    for (const KnotCell& cell : cells) {
      set_cell_rule(cell.polygon, degree, rule);
      start_element(cell, rule, elements);
      const int total = static_cast<int>(rule.points.size());
      for (int first = 0; first < total; first += kLanes) {
        const int count = std::min(total - first, kLanes);
        if (used_ + count > kLanes) flush(elements);
        batch_.push_back({static_cast<int>(elements.size()) - 1, used_, first, count});
        add_points(cell, rule, first, count);
        if (total > kLanes) flush(elements);  // such cells share no batch: all theirs are alike
      }
    }
    flush(elements);
    return elements;
  }

 private:
  // Points first .. first + count - 1 of an element, in the batch from `lane` on.
  struct Part {
    int element, lane, first, count;
  };

  void start_element(const KnotCell& cell, const CellRule& rule,
                     std::vector<QuadratureElement<2>>& elements) const {
    QuadratureElement<2> e;
    e.region = region_;
    e.patch = triangle_;
    e.in_band = cell.in_band;
    e.in_two_sided_band = cell.in_two_sided_band;
    const auto count = static_cast<Eigen::Index>(rule.points.size());
    e.points.resize(2, count);
    for (Eigen::Index i = 0; i < count; ++i) e.points.col(i) = rule.points[i];
    e.weights = Eigen::Map<const Eigen::VectorXd>(rule.weights.data(), count);
    elements.push_back(std::move(e));
  }

  void add_points(const KnotCell& cell, const CellRule& rule, int first, int count) {
    for (int i = first; i < first + count; ++i, ++used_) {
      lanes_.x[used_] = rule.points[i].x();
      lanes_.y[used_] = rule.points[i].y();
      lanes_.side_x[used_] = cell.centroid.x();
      lanes_.side_y[used_] = cell.centroid.y();
    }
  }

  // Evaluates the lanes filled so far and hands the values to their elements.
  void flush(std::vector<QuadratureElement<2>>& elements) {
    if (used_ == 0) return;
    fill_lanes(lanes_, used_);
    std::fill(lanes_.inside_x, lanes_.inside_x + kLanes, inside_.x());
    std::fill(lanes_.inside_y, lanes_.inside_y + kLanes, inside_.y());
    evaluator_.evaluate(lanes_, {&triangle_, 1}, derivatives_, scratch_);
    sort_functions();
    for (const Part& part : batch_) store(part, elements[part.element]);
    batch_.clear();
    used_ = 0;
  }

  void sort_functions() {
    const auto found = scratch_.control_points();
    order_.resize(found.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(), [&](int a, int b) { return found[a] < found[b]; });
  }

  // The matrix of a quantity: value, d/dx, d/dy, d2/dxx, d2/dxy, d2/dyy.
  static Eigen::MatrixXd& matrix_of(QuadratureElement<2>& e, int quantity) {
    if (quantity == 0) return e.values;
    return quantity < 3 ? e.gradients[quantity - 1] : e.hessians[quantity - 3];
  }

  // The functions that do not vanish in the cell, by control point. Cells of several batches find the same
  // functions in each, since their sides are frozen, and keep all of them.
  void choose_functions(const Part& part, QuadratureElement<2>& e) {
    constexpr double kZero = 1e-13;
    const auto found = scratch_.control_points();
    chosen_.clear();
    for (int f : order_) {
      bool vanishes = part.count == e.points.cols();
      double unit = 1.0;
      for (int quantity = 0; quantity < kQuantities[derivatives_] && vanishes; ++quantity) {
        if (quantity == 1 || quantity == 3) unit *= size_;
        const double* lane = scratch_.lanes(f, quantity) + part.lane;
        for (int p = 0; p < part.count; ++p)
          vanishes = vanishes && unit * std::abs(lane[p]) < kZero;
      }
      if (!vanishes) chosen_.push_back(f);
    }
    e.control_points.resize(chosen_.size());
    for (std::size_t i = 0; i < chosen_.size(); ++i) e.control_points[i] = found[chosen_[i]];
    const auto rows = static_cast<Eigen::Index>(chosen_.size());
    if (derivatives_ > 0) e.gradients.resize(2);
    if (derivatives_ > 1) e.hessians.resize(3);
    for (int quantity = 0; quantity < kQuantities[derivatives_]; ++quantity) {
      matrix_of(e, quantity).resize(rows, e.points.cols());
    }
  }

  void store(const Part& part, QuadratureElement<2>& e) {
    if (part.first == 0) choose_functions(part, e);
    for (int quantity = 0; quantity < kQuantities[derivatives_]; ++quantity) {
      Eigen::MatrixXd& target = matrix_of(e, quantity);
      double* to = target.data() + part.first * target.rows();
      for (std::size_t i = 0; i < chosen_.size(); ++i) {
        const double* lane = scratch_.lanes(chosen_[i], quantity) + part.lane;
        for (int p = 0; p < part.count; ++p) to[p * target.rows() + i] = lane[p];
      }
    }
  }

  const TriangularBSplineEvaluator& evaluator_;
  const int triangle_;
  const int derivatives_;
  TriangularBSplineEvaluator::Scratch& scratch_;
  Point<2> inside_;
  int region_ = 0;
  double size_ = 1.0;
  LanePoints lanes_;
  int used_ = 0;
  std::vector<Part> batch_;
  std::vector<int> order_, chosen_;  // functions of the scratch
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

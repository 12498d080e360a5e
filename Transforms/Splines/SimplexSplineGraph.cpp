#include "Transforms/Splines/SimplexSplineGraph.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/KnotSetIndex.h"

namespace crease {

// Builds the nodes from the functions downwards. Knots are numbered; knots of one cloud that coincide
// share a number.
template <int Dim>
class SimplexSplineGraph<Dim>::Builder {
 public:
  explicit Builder(SimplexSplineGraph& graph) : graph_(graph) {}

  void build(const SimplexMesh<Dim>& mesh, const std::vector<std::vector<Point<Dim>>>& clouds) {
    number_knots(clouds, 1e-12 * mesh_scale(mesh));
    const auto betas = multi_indices<Dim>(graph_.degree_);
    for (const auto& simplex : mesh.simplices) {
      for (const auto& beta : betas) graph_.tops_.push_back(top(simplex, beta));
    }
    auto merged = merge_planes<Dim>(facets_, graph_.tie_);
    graph_.planes_ = std::move(merged.planes);
    for (Node& node : graph_.nodes_) {
      if (node.degree > 0) continue;
      for (int& link : node.links) link = merged.plane_of_facet[link];
      set_sides(node);
    }
  }

 private:
  void number_knots(const std::vector<std::vector<Point<Dim>>>& clouds, double same) {
    for (const auto& cloud : clouds) {
      const auto first = static_cast<int>(numbers_.size());
      for (int k = 0; k <= graph_.degree_; ++k) {
        const Point<Dim>& knot = k < static_cast<int>(cloud.size()) ? cloud[k] : cloud[0];
        int number = static_cast<int>(knots_.size());
        for (int l = 0; l < k; ++l) {
          if ((knots_[numbers_[first + l]] - knot).norm() <= same) number = numbers_[first + l];
        }
        if (number == static_cast<int>(knots_.size())) knots_.push_back(knot);
        numbers_.push_back(number);
      }
    }
  }

  int knot_number(int vertex, int k) const { return numbers_[vertex * (graph_.degree_ + 1) + k]; }

  Top top(const std::array<int, Dim + 1>& simplex, const MultiIndex<Dim>& beta) {
    KnotSet set;
    std::array<Point<Dim>, Dim + 1> corners;
    for (int j = 0; j <= Dim; ++j) {
      for (int k = 0; k <= beta[j]; ++k) set.insert(knot_number(simplex[j], k));
      corners[j] = knots_[knot_number(simplex[j], beta[j])];
    }
    return {node(set), std::abs(signed_content<Dim>(corners))};
  }

  int node(const KnotSet& set) {
    const auto [slot, inserted] = index_.insert(set, kNone);
    if (!inserted) return index_.value(slot);
    const int number = make_node(set);
    index_.value(index_.find(set)) = number;  // the children may have moved the slots
    return number;
  }

  int make_node(const KnotSet& set) {
    std::vector<Point<Dim>> points;
    for (int i = 0; i < set.size; ++i) points.push_back(knots_[set.knots[i]]);
    const SplitSet<Dim> split = largest_split_set<Dim>(points);
    if (split.determinant == 0.0) return kNone;

    Node node;
    node.degree = set.size - Dim - 1;
    std::array<Point<Dim>, Dim + 1> corners;
    for (int j = 0; j <= Dim; ++j) corners[j] = points[split.position[j]];
    node.origin = corners[0];
    node.gradients = barycentric_gradients<Dim>(corners);
    node.constants.setZero();
    node.constants[0] = 1.0;
    node.leaf_value = 1.0 / std::abs(split.determinant);
    set_slab(node, points);
    for (int j = 0; j <= Dim; ++j) {
      node.links[j] =
          node.degree == 0 ? add_facet(corners, j) : this->node(set.without(split.position[j]));
    }
    graph_.nodes_.push_back(node);
    return static_cast<int>(graph_.nodes_.size()) - 1;
  }

  int add_facet(const std::array<Point<Dim>, Dim + 1>& corners, int opposite) {
    std::array<Point<Dim>, Dim> facet;
    for (int j = 0, k = 0; j <= Dim; ++j) {
      if (j != opposite) facet[k++] = corners[j];
    }
    facets_.push_back(facet);
    return static_cast<int>(facets_.size()) - 1;
  }

  // The slab normal to the longest pair: narrow where knots of a strip lie close to an edge's line.
  void set_slab(Node& node, const std::vector<Point<Dim>>& points) const {
    Vector<Dim> longest = Vector<Dim>::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const Vector<Dim> d = points[i] - points[k];
        if (d.squaredNorm() > longest.squaredNorm()) longest = d;
      }
    }
    node.slab_normal = flag_towards<Dim>(longest, Point<Dim>::Zero())[1].normalized();
    node.slab_lower = std::numeric_limits<double>::infinity();
    node.slab_upper = -node.slab_lower;
    for (const auto& p : points) {
      node.slab_lower = std::min(node.slab_lower, node.slab_normal.dot(p) - graph_.tie_);
      node.slab_upper = std::max(node.slab_upper, node.slab_normal.dot(p) + graph_.tie_);
    }
  }

  // A leaf's corner j lies on the side of facet j on which the leaf is; kept in constants.
  void set_sides(Node& node) const {
    for (int j = 0; j <= Dim; ++j) {
      const bool positive = node.gradients.col(j).dot(graph_.planes_[node.links[j]].normal) > 0.0;
      node.constants[j] = positive ? 1.0 : -1.0;
    }
  }

  SimplexSplineGraph& graph_;
  std::vector<Point<Dim>> knots_;
  std::vector<int> numbers_;  // of t_{i,k} at i (degree + 1) + k
  std::vector<std::array<Point<Dim>, Dim>> facets_;
  KnotSetIndex index_;
};

namespace {

// What one thread keeps between points: values and sides are valid when their stamp is the point's.
struct Scratch {
  std::vector<std::uint64_t> node_stamp, plane_stamp;
  std::vector<double> value;
  std::vector<signed char> side;
  std::uint64_t stamp = 0;

  void begin(std::size_t nodes, std::size_t planes) {
    if (node_stamp.size() < nodes) {
      node_stamp.resize(nodes, 0);
      value.resize(nodes);
    }
    if (plane_stamp.size() < planes) {
      plane_stamp.resize(planes, 0);
      side.resize(planes);
    }
    ++stamp;
  }
};

}  // namespace

// The values of all nodes at one point, each computed when first asked for.
template <int Dim>
class SimplexSplineGraph<Dim>::Pass {
 public:
  Pass(const SimplexSplineGraph& graph, const Point<Dim>& u,
       std::span<const Vector<Dim>> directions, Scratch& scratch)
      : graph_(graph), u_(u), directions_(directions), scratch_(scratch) {
    scratch_.begin(graph.nodes_.size(), graph.planes_.size());
  }

  double value(int number) {
    if (number == kNone) return 0.0;
    if (scratch_.node_stamp[number] == scratch_.stamp) return scratch_.value[number];
    const Node& node = graph_.nodes_[number];
    double sum = 0.0;
    const double height = node.slab_normal.dot(u_);
    if (height >= node.slab_lower && height <= node.slab_upper) {
      sum = node.degree == 0 ? leaf(node) : inner(node);
    }
    scratch_.node_stamp[number] = scratch_.stamp;
    scratch_.value[number] = sum;
    return sum;
  }

  Vector<Dim> gradient(int number) {
    Vector<Dim> sum = Vector<Dim>::Zero();
    if (number == kNone || graph_.nodes_[number].degree == 0) return sum;
    const Node& node = graph_.nodes_[number];
    for (int j = 0; j <= Dim; ++j) sum += value(node.links[j]) * node.gradients.col(j);
    return node.degree * sum;
  }

  typename SplineJet<Dim>::SecondDerivatives hessian(int number) {
    typename SplineJet<Dim>::SecondDerivatives sum;
    sum.setZero();
    if (number == kNone || graph_.nodes_[number].degree < 2) return sum;
    const Node& node = graph_.nodes_[number];
    for (int j = 0; j <= Dim; ++j) {
      const Vector<Dim> child = node.degree * gradient(node.links[j]);
      for (int a = 0; a < Dim; ++a) {
        for (int b = a; b < Dim; ++b) {
          sum[second_derivative_index<Dim>(a, b)] += node.gradients(a, j) * child[b];
        }
      }
    }
    return sum;
  }

 private:
  double leaf(const Node& node) {
    for (int j = 0; j <= Dim; ++j) {
      if (side(node.links[j]) != node.constants[j]) return 0.0;
    }
    return node.leaf_value;
  }

  double inner(const Node& node) {
    const Vector<Dim> local = u_ - node.origin;
    double sum = 0.0;
    for (int j = 0; j <= Dim; ++j) {
      const double child = value(node.links[j]);
      if (child != 0.0) sum += (node.gradients.col(j).dot(local) + node.constants[j]) * child;
    }
    return sum;
  }

  int side(int plane) {
    if (scratch_.plane_stamp[plane] == scratch_.stamp) return scratch_.side[plane];
    scratch_.plane_stamp[plane] = scratch_.stamp;
    double height = graph_.planes_[plane].distance(u_);
    if (std::abs(height) <= graph_.tie_) {
      for (const Vector<Dim>& d : directions_) {
        height = graph_.planes_[plane].normal.dot(d);
        if (std::abs(height) > 1e-13 * d.norm()) break;
      }
    }
    return scratch_.side[plane] = height > 0.0 ? 1 : -1;
  }

  const SimplexSplineGraph& graph_;
  const Point<Dim> u_;
  std::span<const Vector<Dim>> directions_;
  Scratch& scratch_;
};

template <int Dim>
SimplexSplineGraph<Dim>::SimplexSplineGraph(const SimplexMesh<Dim>& mesh,
                                            const std::vector<std::vector<Point<Dim>>>& clouds,
                                            int degree)
    : degree_(degree), tie_(kKnotTie * mesh_scale(mesh)) {
  Builder(*this).build(mesh, clouds);
}

template <int Dim>
std::vector<typename SimplexSplineGraph<Dim>::Function> SimplexSplineGraph<Dim>::evaluate(
    const Point<Dim>& u, std::span<const Vector<Dim>> directions, std::span<const int> simplices,
    int derivatives) const {
  thread_local Scratch scratch;  // stamps only grow, so that any graph may use it next
  Pass pass(*this, u, directions, scratch);
  std::vector<Function> functions;
  const int per_simplex = num_multi_indices<Dim>(degree_);
  for (int s : simplices) {
    for (int i = 0; i < per_simplex; ++i) {
      const Top& top = tops_[s * per_simplex + i];
      Function f{s, i, {}};
      f.jet.value = top.factor * pass.value(top.node);
      if (derivatives > 0) f.jet.gradient = top.factor * pass.gradient(top.node);
      if (derivatives > 1) f.jet.hessian = top.factor * pass.hessian(top.node);
      const bool vanishes =
          f.jet.value == 0.0 && f.jet.gradient.isZero(0.0) && f.jet.hessian.isZero(0.0);
      if (!vanishes) functions.push_back(f);
    }
  }
  return functions;
}

template class SimplexSplineGraph<2>;
template class SimplexSplineGraph<3>;

}  // namespace crease

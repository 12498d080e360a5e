#pragma once

#include <algorithm>
#include <memory>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/SimplexSplineGraph.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease::testing {

/// `rows` x `count` numbers in [-1, 1].
inline Eigen::MatrixXd random_control_values(int rows, int count, int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(rows, count, [&] { return uniform(random); });
}

/// Jumps of sum_i c_i B_i and its derivatives across lines, from one-sided limits.
class Jumps {
 public:
  /// Norms over all components of the jumps of value, gradient and second derivatives.
  using Norms = Eigen::Vector3d;

  /// @param values  c_i, one column per control point, any number of components.
  Jumps(std::shared_ptr<const TriangularBSplineBasis<2>> basis, Eigen::MatrixXd values)
      : basis_(std::move(basis)),
        values_(std::move(values)),
        graph_(net().mesh, net().clouds, net().degree),
        neighbours_(vertex_neighbours(net().mesh)) {}
  /// One component of random values in [-1, 1].
  Jumps(const KnotNet<2>& net, int seed)
      : Jumps(std::make_shared<const TriangularBSplineBasis<2>>(net), {}) {
    values_ = random_control_values(1, basis_->num_control_points(), seed);
  }

  const TriangularBSplineBasis<2>& basis() const { return *basis_; }
  const KnotNet<2>& net() const { return basis_->net(); }

  /// At x, from one side of the line that the normal crosses to the other.
  Norms across(const Point<2>& x, const Vector<2>& normal) const {
    const Eigen::Index rows = values_.rows();
    Eigen::VectorXd value = Eigen::VectorXd::Zero(rows);
    Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(rows, 2), hessian(rows, 3);
    hessian.setZero();
    const auto& near = neighbours_[basis_->find_simplex(x)];
    for (double sign : {1.0, -1.0}) {
      const std::vector<Vector<2>> flag = {sign * normal, sign * Vector<2>(-normal[1], normal[0])};
      for (const auto& f : graph_.evaluate(x, flag, near, 2)) {
        const Eigen::VectorXd c = sign * values_.col(basis_->control_points_of(f.simplex)[f.index]);
        value += c * f.jet.value;
        gradient += c * f.jet.gradient.transpose();
        hessian += c * f.jet.hessian.transpose();
      }
    }
    return {value.norm(), gradient.norm(), hessian.norm()};
  }

  /// The largest at some points of a segment, within the domain.
  Norms largest(const Point<2>& a, const Point<2>& b) const {
    Norms most = Norms::Zero();
    const double same = 1e-9 * mesh_scale(net().mesh);
    if ((b - a).norm() < same) return most;
    const Vector<2> normal = Vector<2>(a[1] - b[1], b[0] - a[0]).normalized();
    for (double s : {0.05, 0.37, 0.5, 0.81, 0.95}) {
      const Point<2> x = (1 - s) * a + s * b;
      if (!basis_->contains(x + same * normal) || !basis_->contains(x - same * normal)) continue;
      most = most.cwiseMax(across(x, normal));
    }
    return most;
  }

  /// The same over all segments between knots of one cloud, or of the two clouds of an edge.
  Norms largest_on_knot_lines() const {
    Norms most = Norms::Zero();
    for (const auto& [from, to] : edges_and_vertices()) {
      for (const auto& a : net().clouds[from]) {
        for (const auto& b : net().clouds[to]) most = most.cwiseMax(largest(a, b));
      }
    }
    return most;
  }

  /// The same over the mesh edges that `wanted(first vertex, second vertex)` chooses.
  template <typename Wanted>
  Norms largest_on_edges(const Wanted& wanted) const {
    Norms most = Norms::Zero();
    for (const auto& [a, b] : edges_and_vertices()) {
      if (a != b && wanted(a, b)) {
        most = most.cwiseMax(largest(net().mesh.vertices[a], net().mesh.vertices[b]));
      }
    }
    return most;
  }

 private:
  std::set<std::pair<int, int>> edges_and_vertices() const {
    std::set<std::pair<int, int>> pairs;
    for (const auto& t : net().mesh.simplices) {
      for (int a : t) {
        for (int b : t) pairs.insert(std::minmax(a, b));
      }
    }
    return pairs;
  }

  std::shared_ptr<const TriangularBSplineBasis<2>> basis_;
  Eigen::MatrixXd values_;
  SimplexSplineGraph<2> graph_;
  std::vector<std::vector<int>> neighbours_;
};

/// Whether the edge is one of the net's creases.
inline bool is_crease(const KnotNet<2>& net, int a, int b) {
  return std::any_of(net.crease_edges.begin(), net.crease_edges.end(), [&](const CreaseEdge& e) {
    return e.vertices == std::array{a, b} || e.vertices == std::array{b, a};
  });
}

}  // namespace crease::testing

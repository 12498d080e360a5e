#pragma once

#include <Eigen/SparseLU>
#include <array>
#include <functional>
#include <map>
#include <vector>

#include "Transforms/Domains/SimplexMesh.h"
#include "Transforms/Energies/ElasticMaterial.h"

namespace crease::testing {

/// Quadratic Lagrange elements for St. Venant-Kirchhoff bodies, straight from the textbook and apart from
/// the library: Voigt vectors, nodes at vertices and middles of edges, a rule of degree 5.
/// Source: J. Bonet, R. D. Wood, "Nonlinear Continuum Mechanics for Finite Element Analysis", 2008, chapter 9.
class LagrangeBody {
 public:
  using LameOfRegion = std::function<LameParameters(int region)>;

  LagrangeBody(const SimplexMesh<2>& mesh, LameOfRegion lame)
      : mesh_(mesh), lame_(std::move(lame)), nodes_(mesh.vertices) {
    std::map<std::pair<int, int>, int> middles;
    for (const auto& s : mesh.simplices) {
      std::array<int, 6> element{s[0], s[1], s[2], 0, 0, 0};
      for (int e = 0; e < 3; ++e) {
        const std::pair<int, int> edge = std::minmax(s[e], s[(e + 1) % 3]);
        const auto [found, is_new] = middles.try_emplace(edge, static_cast<int>(nodes_.size()));
        if (is_new) nodes_.emplace_back(0.5 * (nodes_[edge.first] + nodes_[edge.second]));
        element[3 + e] = found->second;
      }
      elements_.push_back(element);
    }
    u_.setZero(2, std::ssize(nodes_));
  }

  const std::vector<Point<2>>& nodes() const { return nodes_; }
  const Eigen::Matrix2Xd& displacements() const { return u_; }

  /// Equilibrium with prescribed displacements of some nodes, in equal steps, each by Newton's method.
  void solve(const std::map<int, Vector<2>>& prescribed, int steps) {
    for (int step = 1; step <= steps; ++step) {
      for (const auto& [node, value] : prescribed) u_.col(node) = value * step / steps;
      for (int iteration = 0; iteration < 30; ++iteration) {
        if (newton_step(prescribed) < 1e-13) break;
      }
    }
  }

  Vector<2> displacement(const Point<2>& x) const {
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      const auto L = barycentric(e, x);
      if (std::min({L[0], L[1], L[2]}) < -1e-12) continue;
      const auto N = shape(L);
      Vector<2> sum = Vector<2>::Zero();
      for (int i = 0; i < 6; ++i) sum += N[i] * u_.col(elements_[e][i]);
      return sum;
    }
    return Vector<2>::Constant(std::numeric_limits<double>::quiet_NaN());
  }

 private:
  std::array<double, 3> barycentric(std::size_t e, const Point<2>& x) const {
    const auto& s = mesh_.simplices[e];
    const auto area = [&](const Point<2>& a, const Point<2>& b, const Point<2>& c) {
      return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
    };
    const Point<2>&a = nodes_[s[0]], &b = nodes_[s[1]], &c = nodes_[s[2]];
    const double whole = area(a, b, c);
    return {area(x, b, c) / whole, area(a, x, c) / whole, area(a, b, x) / whole};
  }
  static std::array<double, 6> shape(const std::array<double, 3>& L) {
    return {L[0] * (2 * L[0] - 1), L[1] * (2 * L[1] - 1), L[2] * (2 * L[2] - 1),
            4 * L[0] * L[1],       4 * L[1] * L[2],       4 * L[2] * L[0]};
  }
  /// Gradients of the six functions, 2 x 6.
  Eigen::Matrix<double, 2, 6> gradients(std::size_t e, const std::array<double, 3>& L) const {
    const auto& s = mesh_.simplices[e];
    Eigen::Matrix<double, 2, 3> g;  // of L
    const double twice = signed_content<2>({nodes_[s[0]], nodes_[s[1]], nodes_[s[2]]});
    for (int i = 0; i < 3; ++i) {
      const Vector<2> side = nodes_[s[(i + 2) % 3]] - nodes_[s[(i + 1) % 3]];
      g.col(i) = Vector<2>(-side.y(), side.x()) / twice;
    }
    Eigen::Matrix<double, 2, 6> G;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      G.col(i) = (4 * L[i] - 1) * g.col(i);
      G.col(3 + i) = 4 * (L[i] * g.col(j) + L[j] * g.col(i));
    }
    return G;
  }
  /// One Newton step of the free nodes; returns its largest entry.
  double newton_step(const std::map<int, Vector<2>>& prescribed) {
    const double r = std::sqrt(15.0);
    struct Orbit {
      double a, weight;
    };
    const std::array<Orbit, 2> orbits = {Orbit{(6 + r) / 21, (155 + r) / 1200},
                                         Orbit{(6 - r) / 21, (155 - r) / 1200}};
    std::vector<std::pair<std::array<double, 3>, double>> rule = {
        {{1. / 3, 1. / 3, 1. / 3}, 0.225}};
    for (const auto& [a, weight] : orbits) {
      rule.push_back({{a, a, 1 - 2 * a}, weight});
      rule.push_back({{a, 1 - 2 * a, a}, weight});
      rule.push_back({{1 - 2 * a, a, a}, weight});
    }
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(2 * std::ssize(nodes_));
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      const auto& s = mesh_.simplices[e];
      const double area = 0.5 * signed_content<2>({nodes_[s[0]], nodes_[s[1]], nodes_[s[2]]});
      const auto [lambda, mu] = lame_(mesh_.region(static_cast<int>(e)));
      Eigen::Matrix3d C;
      C << lambda + 2 * mu, lambda, 0, lambda, lambda + 2 * mu, 0, 0, 0, mu;
      Eigen::Matrix<double, 12, 12> K = Eigen::Matrix<double, 12, 12>::Zero();
      Eigen::Matrix<double, 12, 1> R = Eigen::Matrix<double, 12, 1>::Zero();
      for (const auto& [L, weight] : rule) {
        const auto G = gradients(e, L);
        Matrix<2> F = Matrix<2>::Identity();
        for (int i = 0; i < 6; ++i) F += u_.col(elements_[e][i]) * G.col(i).transpose();
        const Matrix<2> E = 0.5 * (F.transpose() * F - Matrix<2>::Identity());
        const Eigen::Vector3d stress = C * Eigen::Vector3d(E(0, 0), E(1, 1), 2 * E(0, 1));
        Matrix<2> S;
        S << stress[0], stress[2], stress[2], stress[1];
        Eigen::Matrix<double, 3, 12> B;
        for (int i = 0; i < 6; ++i) {
          for (int a = 0; a < 2; ++a) {
            B.col(2 * i + a) << F(a, 0) * G(0, i), F(a, 1) * G(1, i),
                F(a, 0) * G(1, i) + F(a, 1) * G(0, i);
          }
        }
        K += area * weight * B.transpose() * C * B;
        R += area * weight * B.transpose() * stress;
        const Eigen::Matrix<double, 6, 6> geometric = area * weight * G.transpose() * S * G;
        for (int a = 0; a < 2; ++a) {
          for (int i = 0; i < 6; ++i) {
            for (int k = 0; k < 6; ++k) K(2 * i + a, 2 * k + a) += geometric(i, k);
          }
        }
      }
      for (int i = 0; i < 12; ++i) {
        const int row = 2 * elements_[e][i / 2] + i % 2;
        force[row] += R[i];
        for (int k = 0; k < 12; ++k) {
          entries.emplace_back(row, 2 * elements_[e][k / 2] + k % 2, K(i, k));
        }
      }
    }
    return solve_free(prescribed, entries, force);
  }
  double solve_free(const std::map<int, Vector<2>>& prescribed,
                    const std::vector<Eigen::Triplet<double>>& entries,
                    const Eigen::VectorXd& force) {
    std::vector<int> number(2 * nodes_.size(), -1);
    int count = 0;
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (!prescribed.contains(static_cast<int>(i / 2))) number[i] = count++;
    }
    std::vector<Eigen::Triplet<double>> free_entries;
    for (const auto& t : entries) {
      if (number[t.row()] < 0 || number[t.col()] < 0) continue;
      free_entries.emplace_back(number[t.row()], number[t.col()], t.value());
    }
    Eigen::SparseMatrix<double> K(count, count);
    K.setFromTriplets(free_entries.begin(), free_entries.end());
    Eigen::VectorXd rhs(count);
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (number[i] >= 0) rhs[number[i]] = -force[i];
    }
    const Eigen::VectorXd step = Eigen::SparseLU<Eigen::SparseMatrix<double>>(K).solve(rhs);
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (number[i] >= 0) u_.data()[i] += step[number[i]];
    }
    return step.cwiseAbs().maxCoeff();
  }

  const SimplexMesh<2> mesh_;
  LameOfRegion lame_;
  std::vector<Point<2>> nodes_;
  std::vector<std::array<int, 6>> elements_;
  Eigen::Matrix2Xd u_;
};

}  // namespace crease::testing

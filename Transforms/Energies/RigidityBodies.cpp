// The bodies of the rigidity energy as wholes: their rotations, the Hessian of bodies that are nearly
// rigid, and the quadratic stand-in.
#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "Core/Parallel.h"
#include "Transforms/Energies/RigidityEnergy.h"
#include "Transforms/Rotation.h"

namespace crease {
namespace {

/// Sums over a patch's cells: int w grad B_i dx and int w grad B_i grad B_k^T dx.
template <int Dim>
struct PatchMoments {
  double measure = 0;
  ControlPoints<Dim> moments;
  std::array<Eigen::MatrixXd, Dim * Dim> products;  // (a, b) at Dim a + b: of d/dx_a and d/dx_b

  void resize(Eigen::Index m) {
    moments.setZero(Dim, m);
    for (auto& product : products) product.setZero(m, m);
  }
  void add(const Eigen::MatrixXd& gradients, const Eigen::VectorXd& weights,
           const std::vector<int>& positions) {
    const Eigen::Index q = weights.size();
    measure += weights.sum();
    for (int a = 0; a < Dim; ++a) {
      const Eigen::MatrixXd weighted = gradients.middleCols(a * q, q) * weights.asDiagonal();
      moments.row(a)(positions) += weighted.rowwise().sum();
      for (int b = 0; b < Dim; ++b) {
        products[Dim * a + b](positions, positions) +=
            weighted * gradients.middleCols(b * q, q).transpose();
      }
    }
  }
  Matrix<Dim> coupling(std::size_t i, std::size_t k) const {
    Matrix<Dim> sum;
    for (int a = 0; a < Dim; ++a) {
      for (int b = 0; b < Dim; ++b) sum(a, b) = products[Dim * a + b](i, k);
    }
    return sum;
  }
};

void sort_unique(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// Adds up couplings of the same pair, in their order.
template <typename Coupling>
void merge(std::vector<Coupling>& couplings) {
  std::stable_sort(couplings.begin(), couplings.end(), [](const Coupling& a, const Coupling& b) {
    return std::pair(a.i, a.k) < std::pair(b.i, b.k);
  });
  std::size_t kept = 0;
  for (std::size_t n = 0; n < couplings.size(); ++n) {
    const bool same = kept > 0 && couplings[kept - 1].i == couplings[n].i &&
                      couplings[kept - 1].k == couplings[n].k;
    if (same) {
      couplings[kept - 1].sum += couplings[n].sum;
    } else {
      couplings[kept++] = couplings[n];
    }
  }
  couplings.resize(kept);
}

}  // namespace

template <int Dim>
void RigidityEnergy<Dim>::make_bodies() {
  std::map<int, std::size_t> of_region;
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    std::size_t body = bodies_.size();
    if (patches_[p].region >= 0)
      body = of_region.try_emplace(patches_[p].region, body).first->second;
    if (body == bodies_.size()) bodies_.emplace_back();
    bodies_[body].patches.push_back(static_cast<int>(p));
  }
  std::vector<PatchMoments<Dim>> parts(patches_.size());
  parallel_for(std::ssize(patches_), [&](std::int64_t p) {
    PatchMoments<Dim>& part = parts[p];
    part.resize(std::ssize(patches_[p].control_points));
    for (const Cell& cell : patches_[p].cells) {
      part.add(*cell.gradients, cell.weights, cell.positions);
    }
  });
  for (Body& body : bodies_) {
    for (int p : body.patches) {
      const auto& points = patches_[p].control_points;
      body.control_points.insert(body.control_points.end(), points.begin(), points.end());
      for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t k = 0; k <= i; ++k) {
          const Matrix<Dim> sum = parts[p].coupling(i, k);
          if (!sum.isZero(0)) body.couplings.push_back({points[i], points[k], sum});
        }
      }
    }
    sort_unique(body.control_points);
    merge(body.couplings);
    body.moments.setZero(Dim, std::ssize(body.control_points));
    for (int p : body.patches) {
      body.measure += parts[p].measure;
      const auto& points = patches_[p].control_points;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const auto at = std::ranges::lower_bound(body.control_points, points[i]);
        body.moments.col(at - body.control_points.begin()) += parts[p].moments.col(i);
      }
    }
  }
}

template <int Dim>
Matrix<Dim> RigidityEnergy<Dim>::rotation_of(
    const Body& body, const Eigen::Ref<const ControlPoints<Dim>>& phi) const {
  const ControlPoints<Dim> local = phi(Eigen::all, body.control_points);
  return nearest_rotation<Dim>(body.measure * linear_ + local * body.moments.transpose());
}

template <int Dim>
void RigidityEnergy<Dim>::add_rigid_hessian(const Body& body, const Matrix<Dim>& rotation,
                                            double scale, BlockHessian<Dim>& hessian) const {
  for (const auto& [i, k, sum] : body.couplings) {
    const Matrix<Dim> turned = rotation * sum.transpose() * rotation.transpose();
    hessian.add(i, k, 0.5 * scale * (sum.trace() * Matrix<Dim>::Identity() + turned));
  }
}

template <int Dim>
void RigidityEnergy<Dim>::add_stiffness(double scale, const HessianPattern& pattern,
                                        std::span<double> stiffness) const {
  for (const Body& body : bodies_) {
    for (const auto& [i, k, sum] : body.couplings) {
      stiffness[pattern.slot(i, k)] += scale * sum.trace();
    }
  }
}

template <int Dim>
bool RigidityEnergy<Dim>::add_pull(const Eigen::Ref<const ControlPoints<Dim>>& phi0, double scale,
                                   ControlPoints<Dim>& pull) const {
  for (const Body& body : bodies_) {
    const Matrix<Dim> turn = rotation_of(body, phi0) - linear_;
    for (std::size_t n = 0; n < body.control_points.size(); ++n) {
      pull.col(body.control_points[n]) += scale * turn * body.moments.col(n);
    }
  }
  return !bodies_.empty();
}

template void RigidityEnergy<2>::make_bodies();
template void RigidityEnergy<3>::make_bodies();
template Matrix<2> RigidityEnergy<2>::rotation_of(const Body&,
                                                  const Eigen::Ref<const ControlPoints<2>>&) const;
template Matrix<3> RigidityEnergy<3>::rotation_of(const Body&,
                                                  const Eigen::Ref<const ControlPoints<3>>&) const;
template void RigidityEnergy<2>::add_rigid_hessian(const Body&, const Matrix<2>&, double,
                                                   BlockHessian<2>&) const;
template void RigidityEnergy<3>::add_rigid_hessian(const Body&, const Matrix<3>&, double,
                                                   BlockHessian<3>&) const;
template void RigidityEnergy<2>::add_stiffness(double, const HessianPattern&,
                                               std::span<double>) const;
template void RigidityEnergy<3>::add_stiffness(double, const HessianPattern&,
                                               std::span<double>) const;
template bool RigidityEnergy<2>::add_pull(const Eigen::Ref<const ControlPoints<2>>&, double,
                                          ControlPoints<2>&) const;
template bool RigidityEnergy<3>::add_pull(const Eigen::Ref<const ControlPoints<3>>&, double,
                                          ControlPoints<3>&) const;

}  // namespace crease

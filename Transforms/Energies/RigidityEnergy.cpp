#include "Transforms/Energies/RigidityEnergy.h"

#include "Core/Error.h"

namespace crease {
namespace {

/// Root mean square of |E| up to which a body counts as nearly rigid.
constexpr double kRigidStrain = 0.1;

/// The weights at the element's points, none in bands that belong to no body.
template <int Dim>
void set_weights(const QuadratureElement<Dim>& element, const WeightField<Dim>& weights,
                 WeightRange& range, Eigen::VectorXd& w) {
  if (element.in_two_sided_band) {
    w.setZero();
  } else if (weights) {
    for (Eigen::Index q = 0; q < w.size(); ++q) {
      w[q] = weights(element.points.col(q), element.region);
    }
    range.add(w.minCoeff<Eigen::PropagateNaN>(), w.maxCoeff<Eigen::PropagateNaN>());
  }
}

/// grad T at point p of a cell from the cell's Dim x (Dim q) table.
template <int Dim>
Matrix<Dim> deformation(const ControlPoints<Dim>& table, Eigen::Index p, Eigen::Index q) {
  Matrix<Dim> f;
  for (int a = 0; a < Dim; ++a) f.col(a) = table.col(a * q + p);
  return f;
}

template <int Dim>
Matrix<Dim> green_strain(const Matrix<Dim>& f) {
  return 0.5 * (f.transpose() * f - Matrix<Dim>::Identity());
}

/// J with J J^T = sum over points and pairs (s, t) of w dE_st dE_st^T: row Dim i + j and column
/// (s, t, point) hold sqrt(w) dE_st/dphi_ij = sqrt(w)/2 (F_js B_i,t + F_jt B_i,s); pairs s < t stand for
/// (t, s) too.
template <int Dim>
Eigen::MatrixXd strain_rows(const Eigen::MatrixXd& gradients, const ControlPoints<Dim>& table,
                            const Eigen::VectorXd& weights) {
  const Eigen::Index k = gradients.rows(), q = weights.size();
  Eigen::MatrixXd rows(Dim * k, kNumSecondDerivatives<Dim> * q);
  for (Eigen::Index p = 0; p < q; ++p) {
    const Matrix<Dim> f = deformation<Dim>(table, p, q);
    for (int s = 0, pair = 0; s < Dim; ++s) {
      for (int t = s; t < Dim; ++t, ++pair) {
        const double factor = 0.5 * std::sqrt(weights[p] * (s == t ? 1 : 2));
        Eigen::Map<ControlPoints<Dim>> column(rows.col(pair * q + p).data(), Dim, k);
        column.noalias() = (factor * f.col(s)) * gradients.col(t * q + p).transpose() +
                           (factor * f.col(t)) * gradients.col(s * q + p).transpose();
      }
    }
  }
  return rows;
}

/// k x k: sum over points of w grad B_i . E grad B_k, what Gauss-Newton leaves out.
template <int Dim>
Eigen::MatrixXd geometric_term(const Eigen::MatrixXd& gradients, const ControlPoints<Dim>& table,
                               const Eigen::VectorXd& weights) {
  const Eigen::Index q = weights.size();
  Eigen::MatrixXd strained = Eigen::MatrixXd::Zero(gradients.rows(), Dim * q);  // w E grad B_i
  for (Eigen::Index p = 0; p < q; ++p) {
    const Matrix<Dim> strain = weights[p] * green_strain<Dim>(deformation<Dim>(table, p, q));
    for (int s = 0; s < Dim; ++s) {
      for (int t = 0; t < Dim; ++t) {
        strained.col(s * q + p) += strain(s, t) * gradients.col(t * q + p);
      }
    }
  }
  return gradients * strained.transpose();
}

}  // namespace

template <int Dim>
RigidityEnergy<Dim>::RigidityEnergy(const SplineBasis<Dim>& basis, const WeightField<Dim>& weights,
                                    const AffineMap<Dim>& affine,
                                    const RigidityOptions<Dim>& options)
    : linear_(affine.linear),
      exact_hessian_(options.exact_hessian),
      num_control_points_(basis.num_control_points()) {
  if (!affine.finite()) throw InvalidInput("RigidityEnergy: the affine part is not finite.");
  const int degree =
      options.quadrature_degree >= 0 ? options.quadrature_degree : basis.product_degree(4, 1);
  WeightRange range;
  const auto wanted = [&](int region, int patch) {
    return (!options.wanted || options.wanted(region, patch)) && !weights.is_constant(region, 0.0);
  };
  patches_ = gradient_patches<Dim>(basis, degree, wanted,
                                   [&](const QuadratureElement<Dim>& element, Eigen::VectorXd& w) {
                                     set_weights(element, weights, range, w);
                                   });
  range.check("RigidityEnergy");
  for (const Patch& patch : patches_) {
    for (const Cell& cell : patch.cells) weighted_measure_ += cell.weights.sum();
  }
  make_bodies();
}

template <int Dim>
void RigidityEnergy<Dim>::add_cell(const Cell& cell, const ControlPoints<Dim>& phi,
                                   bool with_gradient, bool with_hessian, Sums& sums) const {
  const Eigen::MatrixXd& gradients = *cell.gradients;
  const Eigen::Index q = cell.weights.size();
  ControlPoints<Dim> table(Dim, Dim * q);  // grad T
  table.noalias() = phi(Eigen::all, cell.positions) * gradients;
  for (int a = 0; a < Dim; ++a) table.middleCols(a * q, q).colwise() += linear_.col(a);

  ControlPoints<Dim> stress(Dim, Dim * q);  // w F E
  for (Eigen::Index p = 0; p < q; ++p) {
    const Matrix<Dim> f = deformation<Dim>(table, p, q);
    const Matrix<Dim> strain = green_strain<Dim>(f);
    sums.energy += 0.5 * cell.weights[p] * strain.squaredNorm();
    const Matrix<Dim> force = cell.weights[p] * f * strain;
    for (int a = 0; a < Dim; ++a) stress.col(a * q + p) = force.col(a);
  }
  if (with_gradient) {
    const ControlPoints<Dim> gradient = stress * gradients.transpose();
    for (Eigen::Index i = 0; i < gradient.cols(); ++i) {
      sums.gradient.col(cell.positions[i]) += gradient.col(i);
    }
  }
  if (with_hessian) add_hessian(cell, table, sums);
}

template <int Dim>
void RigidityEnergy<Dim>::add_hessian(const Cell& cell, const ControlPoints<Dim>& table,
                                      Sums& sums) const {
  const Eigen::MatrixXd& gradients = *cell.gradients;
  const Eigen::Index k = gradients.rows();
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(Dim * k, Dim * k);
  hessian.selfadjointView<Eigen::Lower>().rankUpdate(
      strain_rows<Dim>(gradients, table, cell.weights));
  if (exact_hessian_) {
    const Eigen::MatrixXd scalar = geometric_term<Dim>(gradients, table, cell.weights);
    for (Eigen::Index c = 0; c < k; ++c) {
      for (Eigen::Index i = c; i < k; ++i) {
        hessian.block<Dim, Dim>(Dim * i, Dim * c).diagonal().array() += scalar(i, c);
      }
    }
  }
  // Positions ascend, so the lower triangle stays the lower one.
  for (Eigen::Index c = 0; c < k; ++c) {
    for (Eigen::Index i = c; i < k; ++i) {
      sums.hessian.template block<Dim, Dim>(Dim * cell.positions[i], Dim * cell.positions[c]) +=
          hessian.block<Dim, Dim>(Dim * i, Dim * c);
    }
  }
}

template <int Dim>
PatchSums<Dim> RigidityEnergy<Dim>::evaluate_patch(const Patch& patch,
                                                   const Eigen::Ref<const ControlPoints<Dim>>& phi,
                                                   bool with_gradient, bool with_hessian) const {
  Sums sums;
  sums.resize(patch, with_gradient, with_hessian);
  const ControlPoints<Dim> local = phi(Eigen::all, patch.control_points);
  for (const Cell& cell : patch.cells) add_cell(cell, local, with_gradient, with_hessian, sums);
  return sums;
}

template <int Dim>
double RigidityEnergy<Dim>::evaluate(const Eigen::Ref<const ControlPoints<Dim>>& phi, double scale,
                                     ControlPoints<Dim>* gradient,
                                     BlockHessian<Dim>* hessian) const {
  if (phi.cols() != num_control_points_) {
    throw InvalidInput(message("RigidityEnergy: ", phi.cols(), " control points given, ",
                               num_control_points_, " expected."));
  }
  std::vector<double> energies;
  double energy = 0;
  add_in_order(
      std::ssize(patches_),
      [&](std::int64_t p) { return evaluate_patch(patches_[p], phi, gradient != nullptr, false); },
      [&](std::int64_t p, const Sums& sums) {
        energies.push_back(sums.energy);
        energy += sums.energy;
        if (gradient) add_gradient(patches_[p], sums, scale, *gradient);
      });
  if (!hessian) return energy;
  for (const Body& body : bodies_) {
    double of_body = 0;
    for (int p : body.patches) of_body += energies[p];
    if (!exact_hessian_ && 2 * of_body <= kRigidStrain * kRigidStrain * body.measure) {
      add_rigid_hessian(body, rotation_of(body, phi), scale, *hessian);
    } else {
      add_strained_hessian(body, phi, scale, *hessian);
    }
  }
  return energy;
}

template <int Dim>
void RigidityEnergy<Dim>::add_strained_hessian(const Body& body,
                                               const Eigen::Ref<const ControlPoints<Dim>>& phi,
                                               double scale, BlockHessian<Dim>& hessian) const {
  add_in_order(
      std::ssize(body.patches),
      [&](std::int64_t n) { return evaluate_patch(patches_[body.patches[n]], phi, false, true); },
      [&](std::int64_t n, const Sums& sums) {
        crease::add_hessian(patches_[body.patches[n]], sums, scale, hessian);
      });
}

template class RigidityEnergy<2>;
template class RigidityEnergy<3>;

}  // namespace crease

#include "Registration/TransformObjective.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Core/Parallel.h"

namespace crease {
namespace {

constexpr Eigen::Index kTile = 32;  // rows of a dense product

double finite(double value, const std::string& term) {
  if (std::isfinite(value)) return value;
  throw SolverError(message("the ", term, " term became ", value,
                            " during the registration; lower the weights or start closer to the "
                            "solution."));
}

/// Adds J D J^T to the lower triangle of H, D made of Dim x Dim blocks, one per point.
template <int Dim>
void add_product(const Eigen::MatrixXd& J, const std::vector<Matrix<Dim>>& D, Eigen::MatrixXd& H) {
  parallel_for((J.rows() + kTile - 1) / kTile, [&](std::int64_t tile) {
    const Eigen::Index first = tile * kTile, rows = std::min(kTile, J.rows() - first);
    Eigen::MatrixXd scaled(rows, J.cols());
    for (std::size_t q = 0; q < D.size(); ++q) {
      const auto column = Dim * static_cast<Eigen::Index>(q);
      scaled.middleCols<Dim>(column).noalias() =
          J.block(first, column, rows, static_cast<Eigen::Index>(Dim)) * D[q];
    }
    H.block(first, 0, rows, first + rows).noalias() += scaled * J.topRows(first + rows).transpose();
  });
}

/// The lower triangle as a sparse matrix, every entry stored.
void store_lower(const Eigen::MatrixXd& dense, Eigen::SparseMatrix<double>& sparse) {
  const auto n = static_cast<int>(dense.cols());
  if (sparse.rows() != n || sparse.nonZeros() != n * (n + 1) / 2) {
    sparse.resize(n, n);
    sparse.resizeNonZeros(n * (n + 1) / 2);
    for (int j = 0, entry = 0; j < n; ++j) {
      sparse.outerIndexPtr()[j] = entry;
      for (int i = j; i < n; ++i) sparse.innerIndexPtr()[entry++] = i;
      sparse.outerIndexPtr()[j + 1] = entry;
    }
  }
  double* values = sparse.valuePtr();
  for (int j = 0; j < n; ++j) values = std::copy_n(&dense(j, j), n - j, values);
}

}  // namespace

template <int Dim>
TransformObjective<Dim>::TransformObjective(std::unique_ptr<Transform<Dim>> transform,
                                            std::shared_ptr<const TransformLattice<Dim>> lattice,
                                            std::shared_ptr<Metric<Dim>> metric,
                                            const AffineMap<Dim>& affine, double detail,
                                            const Weights& weights, SoftLandmarks<Dim> landmarks)
    : transform_(std::move(transform)),
      lattice_(std::move(lattice)),
      affine_(affine),
      landmarks_(std::move(landmarks)) {
  if (lattice_ != nullptr) {
    image_.emplace(lattice_->grid(), std::move(metric), affine_);
    curvature_points_.emplace(lattice_->grid()->raster(), 0.5 * detail);
    for (Eigen::Index q = 0; q < curvature_points_->points().cols(); ++q) {
      points_.push_back(curvature_points_->points().col(q));
    }
  }
  set_weights(weights);
}

template <int Dim>
void TransformObjective<Dim>::set_weights(const Weights& weights) {
  weights_ = weights;
  if (!(weights_.roughness > 0) || roughness_) return;
  roughness_ = transform_->roughness_matrix();
  if (!roughness_) {
    throw InvalidInput(
        "registration: the transform knows no roughness of its own; leave its weight at 0.");
  }
}

template <int Dim>
void TransformObjective<Dim>::renew_jacobian() {
  if (jacobian_.size() > 0 && transform_->linear_in_parameters()) return;
  jacobian_ = transform_->parameter_jacobian(points_);
}

template <int Dim>
double TransformObjective<Dim>::add_image(Eigen::VectorXd* gradient, Eigen::MatrixXd* hessian) {
  const ControlPoints<Dim> phi = lattice_->control_points(*transform_, affine_);
  ControlPoints<Dim> forces = ControlPoints<Dim>::Zero(Dim, phi.cols());
  std::optional<CurvatureBlocks<Dim>> blocks;
  if (hessian != nullptr) blocks.emplace(lattice_->grid()->raster().size);
  const double value = image_->evaluate_blocks(
      phi, weights_.image, gradient != nullptr ? &forces : nullptr, blocks ? &*blocks : nullptr);
  if (gradient != nullptr) lattice_->add_adjoint(*transform_, forces, *gradient);
  if (hessian == nullptr) return value;
  renew_jacobian();
  std::vector<Matrix<Dim>> curvature(points_.size());
  for (int a = 0, s = 0; a < Dim; ++a) {
    for (int b = a; b < Dim; ++b, ++s) {
      const Eigen::VectorXd sums = weights_.image * curvature_points_->sums(*blocks, s);
      for (std::size_t q = 0; q < curvature.size(); ++q) {
        curvature[q](a, b) = curvature[q](b, a) = sums[static_cast<Eigen::Index>(q)];
      }
    }
  }
  add_product<Dim>(jacobian_, curvature, *hessian);
  return value;
}

template <int Dim>
double TransformObjective<Dim>::add_roughness(const Eigen::VectorXd& parameters,
                                              Eigen::VectorXd* gradient,
                                              Eigen::MatrixXd* hessian) const {
  const Eigen::VectorXd product = *roughness_ * parameters;
  if (gradient != nullptr) *gradient += weights_.roughness * product;
  if (hessian != nullptr) *hessian += weights_.roughness * *roughness_;
  return 0.5 * parameters.dot(product);
}

template <int Dim>
double TransformObjective<Dim>::add_landmarks(Eigen::VectorXd* gradient,
                                              Eigen::MatrixXd* hessian) const {
  double value = 0;
  std::vector<Vector<Dim>> forces;
  std::vector<Matrix<Dim>> curvature;
  for (std::size_t j = 0; j < landmarks_.fixed.size(); ++j) {
    const double weight = 1 / (landmarks_.sigma_mm[j] * landmarks_.sigma_mm[j]);
    const Vector<Dim> missed = transform_->map(landmarks_.fixed[j]) - landmarks_.moving[j];
    value += 0.5 * weight * missed.squaredNorm();
    forces.push_back(weights_.landmarks * weight * missed);
    curvature.push_back(weights_.landmarks * weight * Matrix<Dim>::Identity());
  }
  if (gradient != nullptr) transform_->add_adjoint(landmarks_.fixed, forces, *gradient);
  if (hessian != nullptr) {
    add_product<Dim>(transform_->parameter_jacobian(landmarks_.fixed), curvature, *hessian);
  }
  return value;
}

template <int Dim>
double TransformObjective<Dim>::evaluate(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                         Eigen::VectorXd* gradient,
                                         Eigen::SparseMatrix<double>* hessian) {
  transform_->set_parameters(parameters);
  if (gradient != nullptr) gradient->setZero(size());
  Eigen::MatrixXd dense;
  Eigen::MatrixXd* wanted = nullptr;
  if (hessian != nullptr) {
    dense = Eigen::MatrixXd::Zero(size(), size());
    wanted = &dense;
  }
  double value = 0;
  if (image_) {
    terms_["image"] = finite(add_image(gradient, wanted), "image");
    value += weights_.image * terms_["image"];
  }
  if (weights_.roughness > 0) {
    terms_["roughness"] = finite(add_roughness(parameters, gradient, wanted), "roughness");
    value += weights_.roughness * terms_["roughness"];
  }
  if (!landmarks_.fixed.empty() && weights_.landmarks > 0) {
    terms_["landmarks"] = finite(add_landmarks(gradient, wanted), "landmarks");
    value += weights_.landmarks * terms_["landmarks"];
  }
  if (hessian != nullptr) store_lower(dense, *hessian);
  return value;
}

template <int Dim>
double TransformObjective<Dim>::step_length(const Eigen::Ref<const Eigen::VectorXd>& step) const {
  if (!image_ || jacobian_.size() == 0) return ObjectiveFunction::step_length(step);
  const Eigen::VectorXd moved = jacobian_.transpose() * step;
  return moved.reshaped(Dim, points_.size()).colwise().norm().maxCoeff() /
         lattice_->grid()->raster().spacing.minCoeff();
}

template class TransformObjective<2>;
template class TransformObjective<3>;

}  // namespace crease

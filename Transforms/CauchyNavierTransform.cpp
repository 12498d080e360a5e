#include "Transforms/CauchyNavierTransform.h"

#include <cmath>
#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/ParameterCheck.h"

namespace crease {
namespace {

constexpr double kAtCentre = 1e-14;  // in the frame: a point this near to a centre is the centre

/// The kernel in the centres' frame.
template <int Dim>
struct Kernel {
  explicit Kernel(double poisson_ratio) : alpha((Dim == 2 ? 10 : 12) * (1 - poisson_ratio) - 1) {}

  Matrix<Dim> matrix(const Vector<Dim>& y) const {
    const double r = y.norm();
    return (alpha * r * r * r) * Matrix<Dim>::Identity() - (3 * r) * y * y.transpose();
  }
  /// G(y) w.
  Vector<Dim> times(const Vector<Dim>& y, const Vector<Dim>& w) const {
    const double r2 = y.squaredNorm(), r = std::sqrt(r2);
    return (alpha * r2 * r) * w - (3 * r * y.dot(w)) * y;
  }
  /// Its derivative by y.
  Matrix<Dim> slope(const Vector<Dim>& y, const Vector<Dim>& w) const {
    const double r = y.norm(), along = y.dot(w);
    if (r == 0) return Matrix<Dim>::Zero();
    return (3 * alpha * r) * w * y.transpose() - (3 * along / r) * y * y.transpose() -
           (3 * r * along) * Matrix<Dim>::Identity() - (3 * r) * y * w.transpose();
  }
  double alpha;
};

template <int Dim>
Eigen::MatrixXd kernel_matrix(const ControlPoints<Dim>& centres, const Kernel<Dim>& kernel) {
  const Eigen::Index n = centres.cols();
  Eigen::MatrixXd K(Dim * n, Dim * n);
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      K.template block<Dim, Dim>(Dim * i, Dim * k) = kernel.matrix(centres.col(i) - centres.col(k));
    }
  }
  return K;
}

/// Column Dim j + a: the j-th of the functions 1, y_1, y_2, ... as coordinate a.
template <int Dim>
Eigen::MatrixXd affine_matrix(const ControlPoints<Dim>& centres) {
  const Eigen::Index n = centres.cols();
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(Dim * n, Dim * (Dim + 1));
  for (Eigen::Index i = 0; i < n; ++i) {
    for (int a = 0; a < Dim; ++a) {
      P(Dim * i + a, a) = 1;
      for (int j = 0; j < Dim; ++j) P(Dim * i + a, Dim * (j + 1) + a) = centres(j, i);
    }
  }
  return P;
}

double checked_ratio(double poisson_ratio) {
  if (poisson_ratio > -1 && poisson_ratio < 0.5) return poisson_ratio;
  throw InvalidInput(message("CauchyNavierTransform: Poisson's ratio is ", poisson_ratio,
                             "; it must be above -1 and below 0.5."));
}

}  // namespace

template <int Dim>
struct CauchyNavierTransform<Dim>::Body {
  Body(const ControlPoints<Dim>& given_centres, double ratio)
      : centres(given_centres),
        poisson_ratio(checked_ratio(ratio)),
        kernel(ratio),
        frame("CauchyNavierTransform", centres),
        system(kernel_matrix<Dim>(frame.points, kernel), affine_matrix<Dim>(frame.points)) {}

  /// Roughness over f^T E f: the kernel's Fourier transform, and lengths in the frame's.
  double roughness_factor() const {
    return (Dim == 2 ? 180 : 1152) * std::numbers::pi * (1 - poisson_ratio) /
           std::pow(frame.length, 3);
  }

  ControlPoints<Dim> centres;
  double poisson_ratio;
  Kernel<Dim> kernel;
  CentreFrame<Dim> frame;
  CardinalSystem system;
};

template <int Dim>
CauchyNavierTransform<Dim>::CauchyNavierTransform(const ControlPoints<Dim>& centres,
                                                  double poisson_ratio,
                                                  const AffineMap<Dim>& affine)
    : affine_(affine) {
  if (!affine.finite()) {
    throw InvalidInput("CauchyNavierTransform: the affine part is not finite.");
  }
  if (Dim * centres.cols() > kMostCentres) {
    throw InvalidInput(message("CauchyNavierTransform: ", centres.cols(), " centres; at most ",
                               kMostCentres / Dim, " are possible."));
  }
  body_ = std::make_shared<const Body>(centres, poisson_ratio);
  displacements_.setZero(Dim, centres.cols());
  bind();
}

template <int Dim>
const ControlPoints<Dim>& CauchyNavierTransform<Dim>::centres() const {
  return body_->centres;
}

template <int Dim>
double CauchyNavierTransform<Dim>::poisson_ratio() const {
  return body_->poisson_ratio;
}

template <int Dim>
void CauchyNavierTransform<Dim>::bind() {
  const Eigen::VectorXd v = displacements_.reshaped();
  weights_.resize(Dim, displacements_.cols());
  weights_.reshaped() = body_->system.E * v;
  b_.reshaped() = body_->system.A * v;
}

// With w = E f the minimum's condition is (f - y) / v + c w = 0: K w + P a = f = y - c v w.
template <int Dim>
ControlPoints<Dim> CauchyNavierTransform<Dim>::smoothed(
    const ControlPoints<Dim>& values, const Eigen::Ref<const Eigen::VectorXd>& variances) const {
  if (values.cols() != displacements_.cols() || variances.size() != displacements_.cols() ||
      !(variances.array() >= 0).all()) {
    throw InvalidInput(message("CauchyNavierTransform: ", values.cols(), " values and ",
                               variances.size(), " variances to smooth; ", displacements_.cols(),
                               " of both are needed, the variances 0 or more."));
  }
  const Eigen::VectorXd diagonal =
      body_->roughness_factor() *
      variances.transpose().template replicate<Dim, 1>().reshaped().eval();
  Eigen::MatrixXd K = kernel_matrix<Dim>(body_->frame.points, body_->kernel);
  K.diagonal() += diagonal;
  const CardinalSystem system(K, affine_matrix<Dim>(body_->frame.points));
  const Eigen::VectorXd y = values.reshaped();
  const Eigen::VectorXd f = y - diagonal.cwiseProduct(system.E * y);
  return f.reshaped(Dim, values.cols());
}

template <int Dim>
std::unique_ptr<Transform<Dim>> CauchyNavierTransform<Dim>::clone() const {
  return std::make_unique<CauchyNavierTransform>(*this);
}

template <int Dim>
Point<Dim> CauchyNavierTransform<Dim>::map(const Point<Dim>& x) const {
  const Vector<Dim> y = body_->frame.local(x);
  Vector<Dim> u = b_.col(0) + b_.template rightCols<Dim>() * y;
  for (Eigen::Index i = 0; i < weights_.cols(); ++i) {
    u += body_->kernel.times(y - body_->frame.points.col(i), weights_.col(i));
  }
  return affine_(x) + u;
}

template <int Dim>
Matrix<Dim> CauchyNavierTransform<Dim>::spatial_jacobian(const Point<Dim>& x) const {
  const Vector<Dim> y = body_->frame.local(x);
  Matrix<Dim> gradient = b_.template rightCols<Dim>();
  for (Eigen::Index i = 0; i < weights_.cols(); ++i) {
    gradient += body_->kernel.slope(y - body_->frame.points.col(i), weights_.col(i));
  }
  return affine_.linear + gradient / body_->frame.length;
}

template <int Dim>
Eigen::VectorXd CauchyNavierTransform<Dim>::parameters() const {
  return displacements_.reshaped();
}

template <int Dim>
void CauchyNavierTransform<Dim>::set_parameters(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  check_parameters("CauchyNavierTransform", parameters, num_parameters());
  displacements_.reshaped() = parameters;
  bind();
}

template <int Dim>
void CauchyNavierTransform<Dim>::add_adjoint(std::span<const Point<Dim>> x,
                                             std::span<const Vector<Dim>> forces,
                                             Eigen::Ref<Eigen::VectorXd> gradient) const {
  check_adjoint("CauchyNavierTransform", x.size(), forces.size(), gradient.size(),
                num_parameters());
  struct Sums {
    ControlPoints<Dim> at_centres;
    Matrix<Dim, Dim + 1> affine;
    Sums& operator+=(const Sums& other) {
      at_centres += other.at_centres;
      affine += other.affine;
      return *this;
    }
  };
  const Sums zero{ControlPoints<Dim>::Zero(Dim, weights_.cols()), Matrix<Dim, Dim + 1>::Zero()};
  const Sums sums = parallel_sum(
      std::ssize(x), zero,
      [&](std::int64_t k, Sums& sum) {
        const Vector<Dim> y = body_->frame.local(x[k]);
        const Vector<Dim>& force = forces[k];
        sum.affine.col(0) += force;
        sum.affine.template rightCols<Dim>() += force * y.transpose();
        for (Eigen::Index i = 0; i < weights_.cols(); ++i) {  // G is symmetric
          sum.at_centres.col(i) += body_->kernel.times(y - body_->frame.points.col(i), force);
        }
      },
      256);
  gradient += body_->system.E * Eigen::VectorXd(sums.at_centres.reshaped());
  gradient += body_->system.A.transpose() * Eigen::VectorXd(sums.affine.reshaped());
}

template <int Dim>
Eigen::MatrixXd CauchyNavierTransform<Dim>::parameter_jacobian(
    std::span<const Point<Dim>> x) const {
  constexpr int kTile = 32;
  const Eigen::Index n = weights_.cols(), count = std::ssize(x);
  Eigen::MatrixXd result(Dim * n, Dim * count);
  parallel_for((count + kTile - 1) / kTile, [&](std::int64_t tile) {
    const Eigen::Index first = tile * kTile, size = std::min<Eigen::Index>(kTile, count - first);
    ControlPoints<Dim> y(Dim, size);
    Eigen::MatrixXd kernel(Dim * n, Dim * size);
    for (Eigen::Index q = 0; q < size; ++q) {
      y.col(q) = body_->frame.local(x[static_cast<std::size_t>(first + q)]);
      for (Eigen::Index i = 0; i < n; ++i) {
        kernel.template block<Dim, Dim>(Dim * i, Dim * q) =
            body_->kernel.matrix(y.col(q) - body_->frame.points.col(i));
      }
    }
    auto columns = result.middleCols(Dim * first, Dim * size);
    columns.noalias() = body_->system.E * kernel;
    columns.noalias() += body_->system.A.transpose() * affine_matrix<Dim>(y).transpose();
    for (Eigen::Index q = 0; q < size; ++q) {
      Eigen::Index i = 0;
      if ((body_->frame.points.colwise() - y.col(q)).colwise().norm().minCoeff(&i) > kAtCentre) {
        continue;
      }
      result.template middleCols<Dim>(Dim * (first + q)).setZero();
      result.template block<Dim, Dim>(Dim * i, Dim * (first + q)).setIdentity();
    }
  });
  return result;
}

template <int Dim>
std::optional<Eigen::MatrixXd> CauchyNavierTransform<Dim>::roughness_matrix() const {
  return body_->roughness_factor() * body_->system.E;
}

template class CauchyNavierTransform<2>;
template class CauchyNavierTransform<3>;

}  // namespace crease

#include "Transforms/LandmarkFits.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/Splines/ThinPlateBasis.h"

namespace crease {
namespace {

/// Pairs about their means, one column each.
template <int Dim>
struct CentredPairs {
  CentredPairs(std::string_view function, std::span<const Point<Dim>> p,
               std::span<const Point<Dim>> q, std::size_t least) {
    if (p.size() != q.size() || p.size() < least) {
      throw InvalidInput(message(function, ": ", p.size(), " fixed and ", q.size(),
                                 " moving landmarks; as many of both are needed, at least ", least,
                                 "."));
    }
    fixed.resize(Dim, p.size());
    moving.resize(Dim, p.size());
    for (std::size_t j = 0; j < p.size(); ++j) {
      if (!p[j].allFinite() || !q[j].allFinite()) {
        throw InvalidInput(message(function, ": landmark ", j, " is not finite."));
      }
      fixed.col(j) = p[j];
      moving.col(j) = q[j];
    }
    fixed_mean = fixed.rowwise().mean();
    moving_mean = moving.rowwise().mean();
    fixed.colwise() -= fixed_mean;
    moving.colwise() -= moving_mean;
  }
  ControlPoints<Dim> fixed, moving;
  Point<Dim> fixed_mean, moving_mean;
};

/// Number of directions in which centred points spread.
template <int Dim>
int spread(const ControlPoints<Dim>& points) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(points);
  const double largest = svd.singularValues()[0];
  int rank = 0;
  for (Eigen::Index k = 0; k < svd.singularValues().size(); ++k) {
    if (largest > 0 && svd.singularValues()[k] > 1e-9 * largest) ++rank;
  }
  return rank;
}

/// Pairs for a map made of a rotation and perhaps a scale.
template <int Dim>
CentredPairs<Dim> turned_pairs(std::string_view function, std::span<const Point<Dim>> fixed,
                               std::span<const Point<Dim>> moving) {
  CentredPairs<Dim> pairs(function, fixed, moving, Dim);
  if (spread<Dim>(pairs.fixed) < Dim - 1 || spread<Dim>(pairs.moving) < Dim - 1) {
    throw InvalidInput(message(
        function, Dim == 2
                      ? ": all landmarks of one image coincide; give at least two distinct ones."
                      : ": the landmarks of one image lie on one line, so the turn about it is "
                        "free; give at least one off the line."));
  }
  return pairs;
}

/// The rotation that turns the fixed landmarks to the moving ones best, and the sum over landmarks of
/// <R fixed, moving>.
template <int Dim>
std::pair<Matrix<Dim>, double> best_rotation(const CentredPairs<Dim>& pairs) {
  const Matrix<Dim> covariance = pairs.moving * pairs.fixed.transpose();
  const Eigen::JacobiSVD<Matrix<Dim>> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector<Dim> signs = Vector<Dim>::Ones();
  signs[Dim - 1] = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  const Matrix<Dim> r = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return {r, r.cwiseProduct(covariance).sum()};
}

void check_uncertainties(std::span<const double> sigma_mm, std::size_t num_pairs,
                         std::optional<double> lambda) {
  if (!sigma_mm.empty() && sigma_mm.size() != num_pairs) {
    throw InvalidInput(message("fit_thin_plate: ", sigma_mm.size(), " uncertainties for ",
                               num_pairs, " landmarks; one for each is needed, or none."));
  }
  for (std::size_t j = 0; j < sigma_mm.size(); ++j) {
    if (!(sigma_mm[j] >= 0) || !std::isfinite(sigma_mm[j])) {
      throw InvalidInput(message("fit_thin_plate: landmark ", j, " has the uncertainty ",
                                 sigma_mm[j], " mm; it must be finite, 0 or more."));
    }
  }
  if (lambda && (!(*lambda >= 0) || !std::isfinite(*lambda))) {
    throw InvalidInput(
        message("fit_thin_plate: lambda is ", *lambda, "; it must be finite, 0 or more."));
  }
}

/// The smoothest values of the spline that are missed by no more than their variances.
template <int Dim>
Eigen::MatrixXd smoothed_to_uncertainty(const ThinPlateBasis<Dim>& basis,
                                        const Eigen::MatrixXd& values,
                                        const Eigen::VectorXd& variances) {
  const double wanted = Dim * static_cast<double>((variances.array() > 0).count());
  const auto misfit = [&](const Eigen::MatrixXd& f) {
    double sum = 0;
    for (Eigen::Index j = 0; j < f.cols(); ++j) {
      if (variances[j] > 0) sum += (f.col(j) - values.col(j)).squaredNorm() / variances[j];
    }
    return sum;
  };
  // Kernels are about 1 in units of the bounds' size.
  const double unit = std::pow(basis.bounds().diagonal(), 4 - Dim) / variances.maxCoeff();
  double lower = std::log(1e-12 * unit), upper = std::log(1e12 * unit);
  Eigen::MatrixXd best = basis.smoothed(values, std::exp(upper) * variances);
  if (misfit(best) <= wanted) return best;  // affine already
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (lower + upper);
    best = basis.smoothed(values, std::exp(middle) * variances);
    const double found = misfit(best);
    if (found <= wanted && found >= 0.99 * wanted) break;
    (found > wanted ? upper : lower) = middle;
  }
  return best;
}

}  // namespace

template <int Dim>
RigidTransform<Dim> fit_rigid(std::span<const Point<Dim>> fixed,
                              std::span<const Point<Dim>> moving) {
  const auto pairs = turned_pairs<Dim>("fit_rigid", fixed, moving);
  const Matrix<Dim> r = best_rotation(pairs).first;
  return RigidTransform<Dim>(AffineMap<Dim>{r, pairs.moving_mean - r * pairs.fixed_mean},
                             pairs.fixed_mean);
}

template <int Dim>
SimilarityTransform<Dim> fit_similarity(std::span<const Point<Dim>> fixed,
                                        std::span<const Point<Dim>> moving) {
  const auto pairs = turned_pairs<Dim>("fit_similarity", fixed, moving);
  const auto [r, product] = best_rotation(pairs);
  const double scale = product / pairs.fixed.squaredNorm();
  if (!(scale > 0)) {
    throw InvalidInput(
        "fit_similarity: the moving landmarks are a mirror image, or nothing like the fixed ones: "
        "every scale above 0 is worse than 0; check their order.");
  }
  const Matrix<Dim> m = scale * r;
  return SimilarityTransform<Dim>(AffineMap<Dim>{m, pairs.moving_mean - m * pairs.fixed_mean},
                                  pairs.fixed_mean);
}

template <int Dim>
AffineTransform<Dim> fit_affine(std::span<const Point<Dim>> fixed,
                                std::span<const Point<Dim>> moving) {
  const CentredPairs<Dim> pairs("fit_affine", fixed, moving, Dim + 1);
  if (spread<Dim>(pairs.fixed) < Dim) {
    throw InvalidInput(message("fit_affine: the ", fixed.size(), " fixed landmarks lie on one ",
                               Dim == 2 ? "line" : "plane",
                               "; give at least one off it, or fit a rigid map."));
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(pairs.fixed.transpose(),
                                              Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Matrix<Dim> l = svd.solve(pairs.moving.transpose()).transpose();
  return AffineTransform<Dim>(AffineMap<Dim>{l, pairs.moving_mean - l * pairs.fixed_mean},
                              pairs.fixed_mean);
}

template <int Dim>
SplineTransform<Dim> fit_thin_plate(std::span<const Point<Dim>> fixed,
                                    std::span<const Point<Dim>> moving,
                                    std::span<const double> sigma_mm,
                                    std::optional<double> lambda) {
  const CentredPairs<Dim> pairs("fit_thin_plate", fixed, moving, Dim + 1);
  check_uncertainties(sigma_mm, fixed.size(), lambda);
  ControlPoints<Dim> centres(Dim, fixed.size()), shifts(Dim, fixed.size());
  Eigen::VectorXd variances = Eigen::VectorXd::Zero(centres.cols());
  for (std::size_t j = 0; j < fixed.size(); ++j) {
    centres.col(j) = fixed[j];
    shifts.col(j) = moving[j] - fixed[j];
    if (!sigma_mm.empty()) variances[j] = sigma_mm[j] * sigma_mm[j];
  }
  const auto basis = std::make_shared<ThinPlateBasis<Dim>>(centres);
  SplineTransform<Dim> transform(basis);
  if (variances.isZero(0)) {
    transform.set_control_points(shifts);
  } else if (lambda) {
    transform.set_control_points(ControlPoints<Dim>(basis->smoothed(shifts, *lambda * variances)));
  } else {
    transform.set_control_points(
        ControlPoints<Dim>(smoothed_to_uncertainty<Dim>(*basis, shifts, variances)));
  }
  return transform;
}

template RigidTransform<2> fit_rigid(std::span<const Point<2>>, std::span<const Point<2>>);
template RigidTransform<3> fit_rigid(std::span<const Point<3>>, std::span<const Point<3>>);
template AffineTransform<2> fit_affine(std::span<const Point<2>>, std::span<const Point<2>>);
template AffineTransform<3> fit_affine(std::span<const Point<3>>, std::span<const Point<3>>);
template SimilarityTransform<2> fit_similarity(std::span<const Point<2>>,
                                               std::span<const Point<2>>);
template SimilarityTransform<3> fit_similarity(std::span<const Point<3>>,
                                               std::span<const Point<3>>);
template SplineTransform<2> fit_thin_plate(std::span<const Point<2>>, std::span<const Point<2>>,
                                           std::span<const double>, std::optional<double>);
template SplineTransform<3> fit_thin_plate(std::span<const Point<3>>, std::span<const Point<3>>,
                                           std::span<const double>, std::optional<double>);

}  // namespace crease

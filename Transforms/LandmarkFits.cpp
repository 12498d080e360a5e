#include "Transforms/LandmarkFits.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include "Core/Error.h"

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

}  // namespace

template <int Dim>
RigidTransform<Dim> fit_rigid(std::span<const Point<Dim>> fixed,
                              std::span<const Point<Dim>> moving) {
  const CentredPairs<Dim> pairs("fit_rigid", fixed, moving, Dim);
  if (spread<Dim>(pairs.fixed) < Dim - 1 || spread<Dim>(pairs.moving) < Dim - 1) {
    throw InvalidInput(Dim == 2
                           ? "fit_rigid: all landmarks of one image coincide; give at least two "
                             "distinct ones."
                           : "fit_rigid: the landmarks of one image lie on one line, so the turn "
                             "about it is free; give at least one off the line.");
  }
  const Matrix<Dim> covariance = pairs.moving * pairs.fixed.transpose();
  const Eigen::JacobiSVD<Matrix<Dim>> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector<Dim> signs = Vector<Dim>::Ones();
  signs[Dim - 1] = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  const Matrix<Dim> r = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return RigidTransform<Dim>(AffineMap<Dim>{r, pairs.moving_mean - r * pairs.fixed_mean},
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

template RigidTransform<2> fit_rigid(std::span<const Point<2>>, std::span<const Point<2>>);
template RigidTransform<3> fit_rigid(std::span<const Point<3>>, std::span<const Point<3>>);
template AffineTransform<2> fit_affine(std::span<const Point<2>>, std::span<const Point<2>>);
template AffineTransform<3> fit_affine(std::span<const Point<3>>, std::span<const Point<3>>);

}  // namespace crease

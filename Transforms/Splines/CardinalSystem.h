#pragma once

#include <Eigen/Core>
#include <string_view>

#include "Core/Box.h"
#include "Core/Point.h"

namespace crease {

/// Interpolation with a kernel and affine functions, solved once for all values that may be given.
///
/// The interpolant of m numbers f at the centres is s(x) = k(x)^T w + p(x)^T a with w = E f, a = A f,
/// where k(x) holds the kernel's m columns at x and p(x) the q affine functions:
///
///     K w + P a = f,  P^T w = 0:   E = N (N^T K N)^-1 N^T,   A = R^-1 Q^T (I - K E),   P = Q R,
///
/// N an orthonormal basis of what is perpendicular to P. So E is symmetric, positive semi-definite and
/// blind to affine f, f^T E f is the native energy of s, and the cardinal functions B(x) = E k(x) +
/// A^T p(x) take 0 and 1 at the centres and reproduce what P holds.
/// Source: G. Wahba, "Spline Models for Observational Data", SIAM, 1990, 2.4.
struct CardinalSystem {
  /// @param K  m x m, symmetric, positive definite on what is perpendicular to P (a conditionally positive
  ///           definite kernel at distinct centres, diagonal terms for smoothing included).
  /// @param P  m x q, q < m independent columns, or q = m.
  /// @throws SolverError when K is not so to rounding: centres nearly coincide.
  CardinalSystem(const Eigen::MatrixXd& K, const Eigen::MatrixXd& P);

  Eigen::MatrixXd E;  ///< m x m
  Eigen::MatrixXd A;  ///< q x m
};

/// Centres in coordinates of size one about their mean, y = (x - mean) / length: what keeps the kernel's
/// system well scaled.
template <int Dim>
struct CentreFrame {
  /// @param owner  for messages.
  /// @throws InvalidInput unless there are Dim + 1 centres or more, all finite, distinct (the message
  /// names the pair) and not all on one line (2D) or plane (3D).
  CentreFrame(std::string_view owner, const ControlPoints<Dim>& centres);

  Point<Dim> local(const Point<Dim>& x) const { return (x - mean) / length; }

  Point<Dim> mean;
  double length;              ///< mm: from the mean to the farthest centre
  ControlPoints<Dim> points;  ///< y of the centres
};

/// The largest number of centres: beyond it the dense systems take minutes and gigabytes.
inline constexpr int kMostCentres = 4096;

/// Mean distance of neighbours if n centres fill the box evenly, mm.
template <int Dim>
double mean_centre_distance(const Box<Dim>& box, Eigen::Index n);

extern template struct CentreFrame<2>;
extern template struct CentreFrame<3>;

}  // namespace crease

#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "Transforms/Splines/BPatchIndices.h"
#include "Transforms/Splines/KnotPlanes.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// The polynomial that a triangular B-spline is on the core of one simplex.
///
/// The core is the set of points on the inner side of every segment t_{a,i} t_{b,j} (3D: triangle
/// t_{a,i} t_{b,j} t_{c,k}) of used knots, i + j (+ k) <= n, i, j (, k) <= n - 1. Only the simplex's own
/// C(n+Dim, Dim) functions live there, and they are the weights of the B-patch
///
///     w_0 = 1,   w_{beta + e_j}(u) += lambda_j(u | X_beta) w_beta(u),   X_beta = [ t_{i,b_i} ].
///
/// They are kept in power form: w_beta(u) = sum_m matrix(m, beta) X^m, X = (u - centre) / size, monomials
/// and multi-indices in the order of multi_index_position.
/// Source: Seidel, "Symmetric recursive algorithms for surfaces", Constr. Approx. 7, 1991.
template <int Dim>
class BPatch {
 public:
  using Clouds = std::array<std::span<const Point<Dim>>, Dim + 1>;

  /// @param clouds  max(1, degree) knots or more for every corner, the corner first; every X_beta has the
  ///                orientation of the simplex.
  BPatch(const Clouds& clouds, int degree);

  const Eigen::MatrixXd& matrix() const { return matrix_; }
  /// The simplex's centroid, mm.
  const Point<Dim>& centre() const { return centre_; }
  /// Its longest edge, mm.
  double size() const { return size_; }
  /// Whether u lies in the core or within `tie` of it.
  bool in_core(const Point<Dim>& u, double tie) const;
  /// The sides of the core; normals point inwards. Sides that others make superfluous are left out in 2D.
  const std::vector<KnotPlane<Dim>>& core_sides() const { return core_sides_; }
  /// Rows = the functions; columns = values, then (derivatives >= 1) first derivatives, then
  /// (derivatives = 2) second derivatives.
  using Jets =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                    num_multi_indices<Dim>(kMaxSplineDegree), 1 + Dim + kNumSecondDerivatives<Dim>>;
  Jets evaluate(const Point<Dim>& u, int derivatives) const;

 private:
  int degree_;
  Point<Dim> centre_;
  double size_ = 1.0;
  Eigen::MatrixXd matrix_;
  std::vector<KnotPlane<Dim>> core_sides_;
};

/// All sides that bound the core, normals inwards, superfluous ones included.
template <int Dim>
std::vector<KnotPlane<Dim>> core_sides(const typename BPatch<Dim>::Clouds& clouds, int degree);

/// The core as a convex polygon, counter-clockwise; empty when the clouds are too large for the
/// triangle (then the functions do not sum to 1).
std::vector<Point<2>> core_polygon(const BPatch<2>::Clouds& clouds, int degree);

/// The matrix of BPatch for other local coordinates X = (u - centre) / size.
template <int Dim>
Eigen::MatrixXd bpatch_power_form(const typename BPatch<Dim>::Clouds& clouds, int degree,
                                  const Point<Dim>& centre, double size);

extern template class BPatch<2>;
extern template class BPatch<3>;

}  // namespace crease

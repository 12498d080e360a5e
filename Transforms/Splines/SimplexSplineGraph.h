#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "Transforms/Domains/SimplexMesh.h"
#include "Transforms/Splines/BPatchIndices.h"
#include "Transforms/Splines/KnotPlanes.h"
#include "Transforms/Splines/SimplexSpline.h"

namespace crease {

/// All simplex splines of a net with their recurrences, each distinct multiset of knots once: the
/// reference evaluator of triangular (2D) and tetrahedral (3D) B-splines.
///
///     N_beta^I(u) = |det X_beta^I| M(u | V_beta^I),   V_beta^I = { t_{i,0..b_i} },  X_beta^I = [ t_{i,b_i} ]
///
/// A point costs the nodes whose slabs hold it: some 50 per cubic point in 2D. Sides of knot lines
/// are decided once per point and line.
template <int Dim>
class SimplexSplineGraph {
 public:
  /// A local basis function that does not vanish at a point.
  struct Function {
    int simplex = 0;
    int index = 0;  ///< multi_index_position of beta
    SplineJet<Dim> jet;
  };

  /// @param clouds  per vertex degree + 1 knots, or degree knots (then t_degree := t_0).
  SimplexSplineGraph(const SimplexMesh<Dim>& mesh,
                     const std::vector<std::vector<Point<Dim>>>& clouds, int degree);

  /// The functions of the simplices given that do not vanish at u, limits taken along the directions.
  /// @param derivatives  0, 1 or 2.
  std::vector<Function> evaluate(const Point<Dim>& u, std::span<const Vector<Dim>> directions,
                                 std::span<const int> simplices, int derivatives) const;

  int degree() const { return degree_; }
  /// Distinct multisets of knots with volume.
  int num_nodes() const { return static_cast<int>(nodes_.size()); }

 private:
  static constexpr int kNone = -1;
  struct Node {
    int degree = 0;
    // Degree 0: planes of the facets and the side (+1, -1) on which the leaf lies. Otherwise the
    // children M(. | V \ {w_j}) and lambda_j(u) = gradients_j . (u - origin) + constants_j.
    std::array<int, Dim + 1> links{};
    Eigen::Matrix<double, Dim, Dim + 1> gradients;
    Eigen::Matrix<double, Dim + 1, 1> constants;
    Point<Dim> origin;
    double leaf_value = 0.0;
    Vector<Dim> slab_normal;  // along the longest pair of knots
    double slab_lower = 0.0, slab_upper = 0.0;
  };
  struct Top {
    int node = kNone;
    double factor = 0.0;  // |det X_beta|
  };
  class Builder;
  class Pass;

  int degree_;
  double tie_ = 0.0;
  std::vector<Node> nodes_;
  std::vector<KnotPlane<Dim>> planes_;
  std::vector<Top> tops_;  // simplex after simplex
};

extern template class SimplexSplineGraph<2>;
extern template class SimplexSplineGraph<3>;

}  // namespace crease

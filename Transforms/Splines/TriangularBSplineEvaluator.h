#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "Transforms/Domains/KnotNet.h"
#include "Transforms/Splines/KnotControlPoints.h"
#include "Transforms/Splines/KnotEdgeTerms.h"
#include "Transforms/Splines/TriangularBSplineKernels.h"

namespace crease {

/// Evaluates all functions of a triangular B-spline at up to 16 points at once, anywhere in the domain:
/// the fast twin of SimplexSplineGraph.
///
/// Functions N_beta^I are split by X_beta: M(V_beta) = sum_j lambda_j(u | X_beta) M(V_{beta - e_j}), a
/// pyramid down to the indicator of the triangle. Where b_j = 0 the child has lost the cloud of corner j
/// and is a simplex spline of the opposite edge, zero outside the strip along it (KnotEdgeTerms), computed
/// once for both triangles. Within a core only the pyramid remains, the B-patch.
class TriangularBSplineEvaluator {
 public:
  /// What one thread keeps between calls; results of the last call are read from it.
  class Scratch;

  /// @param control_points  must outlive the evaluator.
  TriangularBSplineEvaluator(const KnotNet<2>& net, const KnotControlPoints<2>& control_points);
  TriangularBSplineEvaluator(const TriangularBSplineEvaluator&) = delete;
  TriangularBSplineEvaluator& operator=(const TriangularBSplineEvaluator&) = delete;

  /// Evaluates at the lanes' points (their `tie` is set here). The functions are left in the scratch.
  /// @param holders      the triangles that hold the lanes' side points, each once.
  /// @param derivatives  0, 1 or 2.
  void evaluate(LanePoints& points, std::span<const int> holders, int derivatives,
                Scratch& scratch) const;

  /// Where knot lines that may matter in a triangle cross a segment within it: parameters in (0, 1), in no
  /// order. Between them all functions are polynomials along the segment.
  std::vector<double> breaks_along(int triangle, const Point<2>& a, const Point<2>& b) const;

 private:
  struct Edge {
    KnotEdgeTerms terms;
    std::vector<LaneLine> lines;
    std::array<int, 2> triangles{{-1, -1}};
    // Box of the strip along the edge: projections of the clouds on its direction and its normal.
    Vector<2> along, across;
    double along_lower, along_upper, across_lower, across_upper;
    LaneEdge kernel() const;
  };
  struct Triangle {
    LaneTriangle kernel;          // lambda points into lambdas_
    std::array<int, 3> edges{};   // opposite to the corners
    std::vector<int> near_edges;  // whose strips may reach into the triangle
  };
  void build_edges(const KnotNet<2>& net);
  void build_triangles(const KnotNet<2>& net);
  void set_lines(const KnotNet<2>& net);
  void find_near_edges(const KnotNet<2>& net);
  bool in_strip(const Edge& edge, double x, double y, double half_width, double half_height) const;
  void collect(const LanePoints& points, std::span<const int> holders, Scratch& scratch) const;

  int degree_;
  double tie_;
  const KnotControlPoints<2>& control_points_;
  std::vector<Edge> edges_;
  std::vector<Triangle> triangles_;
  std::vector<double> lambdas_;
  bool avx2_;
};

/// Completes lanes of which the first `used` have (x, y) and (side_x, side_y): chooses 4 or 16 lanes,
/// repeats the last one, and sets the box.
void fill_lanes(LanePoints& points, int used);

class TriangularBSplineEvaluator::Scratch {
 public:
  /// Control points whose functions do not vanish at all points, in no particular order.
  std::span<const int> control_points() const { return found_; }
  /// Value (derivative 0), d/dx, d/dy (1, 2), d2/dxx, d2/dxy, d2/dyy (3, 4, 5) of function i of
  /// control_points() at the lanes.
  const double* lanes(int i, int derivative) const {
    return sums_[0].v + (static_cast<std::size_t>(slot_[i]) * quantities_ + derivative) * lanes_;
  }

 private:
  friend class TriangularBSplineEvaluator;
  struct alignas(32) Four {
    double v[4];
  };
  struct ActiveEdge {
    int edge = 0;
    LaneEdgeValues values{};
    bool nonzero = false;
  };
  int slot_of(int control_point);

  std::uint64_t stamp_ = 0;
  std::vector<std::uint64_t> edge_stamp_, triangle_stamp_, point_stamp_;
  std::vector<int> edge_place_;  // of an active edge
  std::vector<int> point_slot_;  // of a control point in sums_
  std::vector<ActiveEdge> edges_;
  std::vector<int> triangles_;
  std::vector<Four> pool_, sums_;
  std::vector<unsigned char> flags_;
  std::vector<int> used_;      // control point of each slot
  std::vector<char> nonzero_;  // of each slot
  std::vector<int> found_, slot_;
  int quantities_ = 1, lanes_ = 4;
};

}  // namespace crease

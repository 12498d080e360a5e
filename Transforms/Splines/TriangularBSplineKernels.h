#pragma once

namespace crease {

/// Points that are evaluated together, one per lane. Sides of knot lines are decided at (side_x, side_y),
/// polynomials are evaluated at (x, y): the same point, or for a whole cell of the knot lines its
/// centroid and any point. Unused lanes repeat a used one.
struct alignas(32) LanePoints {
  static constexpr int kMaxLanes = 16;
  double x[kMaxLanes], y[kMaxLanes];
  double side_x[kMaxLanes], side_y[kMaxLanes];
  double inside_x[kMaxLanes], inside_y[kMaxLanes];     ///< limits are taken towards this point
  double centre_x, centre_y, half_width, half_height;  ///< box of all (side_x, side_y)
  double tie;  ///< distance from a line that counts as on it
  int lanes;   ///< 4 or 16
};

/// A knot line: distance = nx x + ny y - offset.
struct LaneLine {
  double nx, ny, offset;
};

/// A simplex spline of degree 0: `value` where the side of each line equals its sign (+1, -1).
struct LaneLeaf {
  double value;
  int line[3];
  int sign[3];
};

/// sum_j (lambda[3j] x + lambda[3j+1] y + lambda[3j+2]) child_j, coordinates relative to an origin.
/// Children number the leaves first, then the nodes; -1 = zero.
struct LaneNode {
  double lambda[9];
  int child[3];
};

/// The simplex splines E(p, q) = M(. | a_0..a_p, b_0..b_q), 1 <= p + q <= n, of the clouds of an edge's
/// ends, with their recurrences.
struct LaneEdge {
  double origin_x, origin_y;
  const LaneLine* lines;
  const LaneLeaf* leaves;
  const LaneNode* nodes;  // children come before parents
  const int* slots;       // value number of E(p, q) at m (m + 1) / 2 - 1 + p, m = p + q; -1 = zero
  int num_lines, num_leaves, num_nodes;
};

/// Values of an edge's leaves and nodes, and which of them are not zero in all lanes.
struct LaneEdgeValues {
  double* values;          // lanes per leaf or node
  unsigned char* nonzero;  // per leaf or node
  double* gradients;       // sums of grad lambda_j child_j for E(p, q), p + q = n: x lanes, y lanes
  const int* slots;        // of the edge
};

/// N_beta = det X_beta M(. | V_beta) of one triangle by split sets X_beta: the nodes V_gamma, |gamma| <= n,
/// form a pyramid, and what a set lacks (a cloud used up) are the edges' simplex splines.
struct LaneTriangle {
  double origin_x, origin_y;
  LaneLine sides[3];  // line of the edge opposite to corner i
  int inner[3];       // its side on which the triangle lies
  double base;        // 1 / det of the corners
  const double*
      lambda;      // 9 per node of the levels 1..n (LaneNode); the last level times det X_beta
  int flipped[3];  // edge opposite to i: its first end is corner i+2 instead of i+1
};

// derivatives 0, 1, 2: values; and gradients; and second derivatives (xx, xy, yy).
#define CREASE_TRIANGULAR_KERNELS                                                                    \
  /* Returns whether any E(p, q) is not zero. sides: scratch, num_lines (1 + lanes) doubles. */      \
  bool evaluate_edge(const LaneEdge& edge, const LanePoints& points, int degree, int derivatives,    \
                     const LaneEdgeValues& out, double* sides);                                      \
  /* edges[i]: opposite to corner i, null when zero. Adds function b to targets[b] (value lanes,  */ \
  /* then each derivative's) and returns the bits of the functions that are not zero. */             \
  unsigned evaluate_triangle(const LaneTriangle& triangle, const LanePoints& points, int degree,     \
                             int derivatives, const LaneEdgeValues* const* edges,                    \
                             double* const* targets);

namespace baseline {
CREASE_TRIANGULAR_KERNELS
}
namespace avx2 {
CREASE_TRIANGULAR_KERNELS
}
#undef CREASE_TRIANGULAR_KERNELS

}  // namespace crease

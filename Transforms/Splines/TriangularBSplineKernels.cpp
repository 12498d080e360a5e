#include "Transforms/Splines/TriangularBSplineKernels.h"

namespace crease::CREASE_ISA {
namespace {

using Real4 = double __attribute__((vector_size(32)));
using Mask4 = long long __attribute__((vector_size(32)));

constexpr int kMaxDegree = 5;
constexpr int kMaxPyramid = 35;  // nodes of the levels 0..4

inline Real4 load(const double* p) { return *reinterpret_cast<const Real4*>(p); }
inline void store(double* p, Real4 v) { *reinterpret_cast<Real4*>(p) = v; }
inline Real4 splat(double v) { return Real4{v, v, v, v}; }
inline bool any(Mask4 m) { return (m[0] | m[1] | m[2] | m[3]) != 0; }

constexpr int level_start(int m) { return m * (m + 1) * (m + 2) / 6; }
constexpr int position(int b1, int b2) { return (b1 + b2) * (b1 + b2 + 1) / 2 + b2; }
constexpr int edge_slot(int p, int q) { return (p + q) * (p + q + 1) / 2 - 1 + p; }

// Where the three children of each pyramid node are: V_{beta - e_i} in the pyramid, or E(p, q) of the
// edge opposite to corner i, p knots beyond the first from corner i + 1, q from corner i + 2.
struct Child {
  short node;                // -1: an edge's
  short slot, flipped_slot;  // the edge's first end is corner i + 1, or i + 2
};
struct PyramidLinks {
  Child child[level_start(kMaxDegree + 1)][3];
};

constexpr PyramidLinks make_links() {
  PyramidLinks links{};
  for (int m = 1; m <= kMaxDegree; ++m) {
    for (int b1 = 0; b1 <= m; ++b1) {
      for (int b2 = 0; b1 + b2 <= m; ++b2) {
        const int beta[3] = {m - b1 - b2, b1, b2};
        for (int i = 0; i < 3; ++i) {
          Child& child = links.child[level_start(m) + position(b1, b2)][i];
          const int p = beta[(i + 1) % 3], q = beta[(i + 2) % 3];
          if (beta[i] > 0) {
            child = {
                static_cast<short>(level_start(m - 1) + position(b1 - (i == 1), b2 - (i == 2))), 0,
                0};
          } else {
            child = {-1, static_cast<short>(edge_slot(p, q)), static_cast<short>(edge_slot(q, p))};
          }
        }
      }
    }
  }
  return links;
}
constexpr PyramidLinks kLinks = make_links();

// Which side of a line the lanes lie on.
enum Side : int { kNegative = 0, kPositive = 1, kMixed = 2 };

// On which side a lane on the line counts: the flag (towards `inside`, then turned left).
bool flag_side(const LaneLine& line, const LanePoints& p, int lane) {
  const double dx = p.inside_x[lane] - p.side_x[lane], dy = p.inside_y[lane] - p.side_y[lane];
  const double along = line.nx * dx + line.ny * dy;
  const double length = (dx < 0 ? -dx : dx) + (dy < 0 ? -dy : dy);
  if (along > 1e-13 * length) return true;
  if (along < -1e-13 * length) return false;
  return dx == 0.0 && dy == 0.0 ? line.nx + 0.375 * line.ny > 0.0
                                : line.ny * dx - line.nx * dy > 0.0;
}

// Masks of the lanes on the positive side; written only when mixed.
template <int R>
Side line_side(const LaneLine& line, const LanePoints& p, Mask4* positive) {
  const double height = line.nx * p.centre_x + line.ny * p.centre_y - line.offset;
  const double reach =
      __builtin_fabs(line.nx) * p.half_width + __builtin_fabs(line.ny) * p.half_height + p.tie;
  if (height > reach) return kPositive;
  if (height < -reach) return kNegative;
  Mask4 near_any{};
  for (int r = 0; r < R; ++r) {
    const Real4 h =
        line.nx * load(p.side_x + 4 * r) + line.ny * load(p.side_y + 4 * r) - line.offset;
    positive[r] = h > 0.0;
    near_any |= (h <= p.tie) & (h >= -p.tie);
  }
  if (any(near_any)) {
    for (int lane = 0; lane < 4 * R; ++lane) {
      const double h = line.nx * p.side_x[lane] + line.ny * p.side_y[lane] - line.offset;
      if (__builtin_fabs(h) > 1.5 * p.tie) continue;  // rounded otherwise than the vector at most
      positive[lane / 4][lane % 4] = flag_side(line, p, lane) ? -1 : 0;
    }
  }
  return kMixed;
}

// The lanes inside three half-planes: false when there are none.
template <int R>
bool inside_lanes(const Side* side, const Mask4* positive, const int* line, const int* sign,
                  Mask4* inside) {
  bool full = true;
  for (int i = 0; i < 3; ++i) {
    const Side s = side[line[i]];
    if (s == kMixed) {
      full = false;
    } else if ((s == kPositive) != (sign[i] > 0)) {
      return false;
    }
  }
  for (int r = 0; r < R; ++r) inside[r] = ~Mask4{};
  if (full) return true;
  Mask4 some{};
  for (int i = 0; i < 3; ++i) {
    if (side[line[i]] != kMixed) continue;
    const Mask4* m = positive + R * line[i];
    for (int r = 0; r < R; ++r) inside[r] &= sign[i] > 0 ? m[r] : ~m[r];
  }
  for (int r = 0; r < R; ++r) some |= inside[r];
  return any(some);
}

// sum += (l0 x + l1 y + l2) child.
template <int R>
inline void add_term(const double* l, const Real4* x, const Real4* y, const double* child,
                     Real4* sum) {
  const Real4 a = splat(l[0]), b = splat(l[1]), c = splat(l[2]);
  for (int r = 0; r < R; ++r) sum[r] += (a * x[r] + (b * y[r] + c)) * load(child + 4 * r);
}

template <int R>
bool edge(const LaneEdge& e, const LanePoints& p, int degree, int derivatives,
          const LaneEdgeValues& out, double* scratch) {
  constexpr int kLanes = 4 * R;
  Mask4* positive = reinterpret_cast<Mask4*>(scratch);
  Side* side = reinterpret_cast<Side*>(scratch + kLanes * e.num_lines);
  for (int l = 0; l < e.num_lines; ++l) side[l] = line_side<R>(e.lines[l], p, positive + R * l);

  for (int f = 0; f < e.num_leaves; ++f) {
    const LaneLeaf& leaf = e.leaves[f];
    Mask4 inside[R];
    out.nonzero[f] = inside_lanes<R>(side, positive, leaf.line, leaf.sign, inside);
    if (!out.nonzero[f]) continue;
    const Mask4 bits = reinterpret_cast<Mask4>(splat(leaf.value));
    for (int r = 0; r < R; ++r) {
      store(out.values + kLanes * f + 4 * r, reinterpret_cast<Real4>(bits & inside[r]));
    }
  }

  Real4 x[R], y[R];
  for (int r = 0; r < R; ++r) {
    x[r] = load(p.x + 4 * r) - e.origin_x;
    y[r] = load(p.y + 4 * r) - e.origin_y;
  }
  for (int i = 0; i < e.num_nodes; ++i) {
    const LaneNode& node = e.nodes[i];
    Real4 sum[R] = {};
    bool nonzero = false;
    for (int j = 0; j < 3; ++j) {
      const int c = node.child[j];
      if (c < 0 || !out.nonzero[c]) continue;
      nonzero = true;
      add_term<R>(node.lambda + 3 * j, x, y, out.values + kLanes * c, sum);
    }
    const int number = e.num_leaves + i;
    out.nonzero[number] = nonzero;
    if (!nonzero) continue;
    for (int r = 0; r < R; ++r) store(out.values + kLanes * number + 4 * r, sum[r]);
  }

  bool some = false;
  for (int s = 0; s < edge_slot(degree, 0) + 1; ++s) {
    some = some || (e.slots[s] >= 0 && out.nonzero[e.slots[s]]);
  }
  if (!some || derivatives < 2) return some;
  for (int s = 0; s <= degree; ++s) {
    const int number = e.slots[edge_slot(0, degree) + s];
    if (number < e.num_leaves || !out.nonzero[number]) continue;
    const LaneNode& node = e.nodes[number - e.num_leaves];
    Real4 gx[R] = {}, gy[R] = {};
    for (int j = 0; j < 3; ++j) {
      const int c = node.child[j];
      if (c < 0 || !out.nonzero[c]) continue;
      for (int r = 0; r < R; ++r) {
        const Real4 child = load(out.values + kLanes * c + 4 * r);
        gx[r] += node.lambda[3 * j] * child;
        gy[r] += node.lambda[3 * j + 1] * child;
      }
    }
    for (int r = 0; r < R; ++r) {
      store(out.gradients + kLanes * 2 * s + 4 * r, gx[r]);
      store(out.gradients + kLanes * (2 * s + 1) + 4 * r, gy[r]);
    }
  }
  return some;
}

// Values of the pyramid's nodes below the functions, and their gradient sums on the last level.
template <int R>
struct Pyramid {
  alignas(32) double values[kMaxPyramid][4 * R];
  alignas(32) double gradients[15][2][4 * R];
  bool nonzero[kMaxPyramid];
};

// Child i of a node: its lanes, or null when zero; for the functions also its gradient sums.
template <int R>
struct ChildLanes {
  const double* values = nullptr;
  const double* gradients = nullptr;

  ChildLanes(const LaneTriangle& t, const Pyramid<R>& pyramid, const LaneEdgeValues* const* edges,
             int node, int i, int degree) {
    const Child& child = kLinks.child[node][i];
    if (child.node >= 0) {
      if (!pyramid.nonzero[child.node]) return;
      values = pyramid.values[child.node];
      const int last = child.node - level_start(degree - 1);
      if (last >= 0) gradients = pyramid.gradients[last][0];
      return;
    }
    const LaneEdgeValues* e = edges[i];
    if (!e) return;
    const int slot = t.flipped[i] ? child.flipped_slot : child.slot;
    const int number = e->slots[slot];
    if (number < 0 || !e->nonzero[number]) return;
    values = e->values + 4 * R * number;
    const int last = slot - edge_slot(0, degree);
    if (last >= 0) gradients = e->gradients + 4 * R * 2 * last;
  }
};

template <int R>
bool base_lanes(const LaneTriangle& t, const LanePoints& p, double* values) {
  Side side[3];
  Mask4 positive[3 * R], inside[R];
  const int line[3] = {0, 1, 2};
  for (int i = 0; i < 3; ++i) side[i] = line_side<R>(t.sides[i], p, positive + R * i);
  if (!inside_lanes<R>(side, positive, line, t.inner, inside)) return false;
  const Mask4 bits = reinterpret_cast<Mask4>(splat(t.base));
  for (int r = 0; r < R; ++r) {
    store(values + 4 * r, reinterpret_cast<Real4>(bits & inside[r]));
  }
  return true;
}

inline void add_to(double* target, Real4 v) { store(target, load(target) + v); }

// Adds function b and its derivatives from the last level's nodes.
template <int R, int Derivatives>
bool add_function(const ChildLanes<R>* child, const double* lambda, const Real4* x, const Real4* y,
                  int degree, double* target) {
  constexpr int kLanes = 4 * R;
  bool nonzero = false;
  for (int i = 0; i < 3; ++i) {
    const double* c = child[i].values;
    if (!c) continue;
    nonzero = true;
    const double* l = lambda + 3 * i;
    for (int r = 0; r < R; ++r) {
      const Real4 v = load(c + 4 * r);
      add_to(target + 4 * r, (l[0] * x[r] + (l[1] * y[r] + l[2])) * v);
      if constexpr (Derivatives > 0) {
        add_to(target + kLanes + 4 * r, degree * l[0] * v);
        add_to(target + 2 * kLanes + 4 * r, degree * l[1] * v);
      }
    }
    if constexpr (Derivatives > 1) {
      if (degree < 2) continue;
      const double sx = degree * (degree - 1) * l[0], sy = degree * (degree - 1) * l[1];
      for (int r = 0; r < R; ++r) {
        const Real4 gx = load(child[i].gradients + 4 * r);
        const Real4 gy = load(child[i].gradients + kLanes + 4 * r);
        add_to(target + 3 * kLanes + 4 * r, sx * gx);
        add_to(target + 4 * kLanes + 4 * r, sx * gy);
        add_to(target + 5 * kLanes + 4 * r, sy * gy);
      }
    }
  }
  return nonzero;
}

template <int R, int Derivatives>
unsigned triangle(const LaneTriangle& t, const LanePoints& p, int degree,
                  const LaneEdgeValues* const* edges, double* const* targets) {
  Pyramid<R> pyramid;
  pyramid.nonzero[0] = base_lanes<R>(t, p, pyramid.values[0]);
  if (!pyramid.nonzero[0] && !edges[0] && !edges[1] && !edges[2]) return 0;
  Real4 x[R], y[R];
  for (int r = 0; r < R; ++r) {
    x[r] = load(p.x + 4 * r) - t.origin_x;
    y[r] = load(p.y + 4 * r) - t.origin_y;
  }
  const double* lambda = t.lambda;
  for (int level = 1; level < degree; ++level) {
    for (int node = level_start(level); node < level_start(level + 1); ++node, lambda += 9) {
      Real4 sum[R] = {}, gx[R] = {}, gy[R] = {};
      bool nonzero = false;
      for (int i = 0; i < 3; ++i) {
        const ChildLanes<R> child(t, pyramid, edges, node, i, degree);
        if (!child.values) continue;
        nonzero = true;
        add_term<R>(lambda + 3 * i, x, y, child.values, sum);
        if (Derivatives < 2 || level < degree - 1) continue;
        for (int r = 0; r < R; ++r) {
          gx[r] += lambda[3 * i] * load(child.values + 4 * r);
          gy[r] += lambda[3 * i + 1] * load(child.values + 4 * r);
        }
      }
      pyramid.nonzero[node] = nonzero;
      if (!nonzero) continue;
      for (int r = 0; r < R; ++r) store(pyramid.values[node] + 4 * r, sum[r]);
      if (Derivatives < 2 || level < degree - 1) continue;
      for (int r = 0; r < R; ++r) {
        store(pyramid.gradients[node - level_start(level)][0] + 4 * r, gx[r]);
        store(pyramid.gradients[node - level_start(level)][1] + 4 * r, gy[r]);
      }
    }
  }
  unsigned found = 0;
  for (int b = 0; b < (degree + 1) * (degree + 2) / 2; ++b, lambda += 9) {
    const int node = level_start(degree) + b;
    const ChildLanes<R> child[3] = {{t, pyramid, edges, node, 0, degree},
                                    {t, pyramid, edges, node, 1, degree},
                                    {t, pyramid, edges, node, 2, degree}};
    if (add_function<R, Derivatives>(child, lambda, x, y, degree, targets[b])) found |= 1u << b;
  }
  return found;
}

}  // namespace

bool evaluate_edge(const LaneEdge& e, const LanePoints& points, int degree, int derivatives,
                   const LaneEdgeValues& out, double* sides) {
  return points.lanes == 4 ? edge<1>(e, points, degree, derivatives, out, sides)
                           : edge<4>(e, points, degree, derivatives, out, sides);
}

unsigned evaluate_triangle(const LaneTriangle& t, const LanePoints& points, int degree,
                           int derivatives, const LaneEdgeValues* const* edges,
                           double* const* targets) {
  if (points.lanes == 4) {
    if (derivatives == 0) return triangle<1, 0>(t, points, degree, edges, targets);
    if (derivatives == 1) return triangle<1, 1>(t, points, degree, edges, targets);
    return triangle<1, 2>(t, points, degree, edges, targets);
  }
  if (derivatives == 0) return triangle<4, 0>(t, points, degree, edges, targets);
  if (derivatives == 1) return triangle<4, 1>(t, points, degree, edges, targets);
  return triangle<4, 2>(t, points, degree, edges, targets);
}

}  // namespace crease::CREASE_ISA

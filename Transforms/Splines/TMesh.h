#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "Transforms/Splines/KnotVector.h"

namespace crease {

/// A straight piece of a T-mesh, in numbers of lines: it runs along `axis` (0: u, horizontal; 1: v) on the
/// line number `line` of the other axis, from line `begin` to line `end` of its own.
struct TSegment {
  int axis = 0;
  int line = 0;
  int begin = 0;
  int end = 0;
  bool operator==(const TSegment&) const = default;
};

/// A crossing of lines of a T-mesh: the numbers of the line across u and of the line across v.
using TPoint = std::array<int, 2>;

/// A vertex inside a T-mesh where one of the four edges is missing.
struct TJunction {
  TPoint at;
  int axis = 0;  ///< direction of the missing edge
  int side = 1;  ///< 1: towards larger parameters, -1: towards smaller ones
};

/// A rectangle of a T-mesh between lines lower and upper.
struct TFace {
  TPoint lower, upper;
};

/// The partition of a parameter rectangle that tells a T-spline its blending functions: knot lines that may
/// end at others (at T-junctions), and need not run from border to border.
///
/// Lines are numbered in ascending order of their knots; lines with equal knots stand for repeated ones
/// (columns of no width). All edges lie on lines. For degree n = 2 h - 1 a function belongs to every
/// vertex; its n + 2 knots along u are those of the first h vertical edges met by the ray from the vertex
/// to the left and to the right, touched ones included, and of the vertex itself; likewise along v.
/// Where a ray leaves the mesh the border knot is repeated. The border line stands h times, so that the
/// functions are clamped; these h lines run from end to end, and whatever reaches the innermost of them
/// goes on to the border.
///
/// Analysis-suitable: no extension of a T-junction along u meets one along v. The extension of a T-junction
/// runs over the gap until it has met h edges, and backwards along its edge over h - 1. Then the
/// functions are linearly independent, sum to 1 with no weights, and contain the polynomials of degree n
/// in u and v.
///
/// Sources: T. Sederberg et al., "T-splines and T-NURCCs", 2003 (knots by rays); L. Beirao da Veiga et al.,
/// "Analysis-suitable T-splines of arbitrary degree", 2013; X. Li and M. Scott, "Analysis-suitable
/// T-splines: characterization, refineability, and approximation", 2014.
class TMesh {
 public:
  /// @param degree    1, 3 or 5.
  /// @param lines     knots per axis, ascending; the first and the last (degree + 1) / 2 times.
  /// @param segments  all edges, borders included, in any order; they may overlap.
  /// @throws InvalidInput for lines that are not so or stand too often, and for a mesh that is not made of
  /// rectangles: an edge that ends nowhere, a corner inside, a border that is not complete. It names the place.
  TMesh(int degree, std::array<std::vector<double>, 2> lines,
        const std::vector<TSegment>& segments);
  /// All lines from border to border: the functions are the products of the knot vectors' B-splines.
  /// @throws InvalidInput when the degrees differ or are even.
  static TMesh tensor(const KnotVector& u, const KnotVector& v);

  int degree() const { return degree_; }
  /// (degree + 1) / 2: lines at a border.
  int border_lines() const { return (degree_ + 1) / 2; }
  int num_lines(int axis) const { return static_cast<int>(lines_[axis].size()); }
  const std::vector<double>& lines(int axis) const { return lines_[axis]; }
  /// The knot of a line; those beyond the border (negative ones, say) repeat its knot.
  double knot(int axis, int line) const;

  /// Whether the edge along `axis` from a point to the next line is there.
  bool has_edge(int axis, TPoint from) const;
  /// Whether a point lies on an edge along `axis` or at its end.
  bool touches(int axis, TPoint at) const;
  bool is_vertex(TPoint at) const { return touches(0, at) && touches(1, at); }
  /// All vertices, u fastest: one function each, in this order.
  std::vector<TPoint> vertices() const;
  /// The lines of the degree + 2 knots of a point's function along `axis`; the middle one is the point's.
  std::vector<int> knot_lines(int axis, TPoint at) const;

  std::vector<TJunction> junctions() const;
  /// See above. Along `axis` of the junction.
  TSegment extension(const TJunction& junction) const;
  /// Pairs of T-junctions, the first along u, the second along v, whose extensions meet: one pair for each
  /// second one that meets any.
  std::vector<std::pair<TJunction, TJunction>> crossings() const;
  bool is_analysis_suitable() const { return crossings().empty(); }

  /// Longest edges, in the order that the constructor takes.
  std::vector<TSegment> segments() const;
  std::vector<TFace> faces() const;
  /// The mesh with the gaps' parts of all extensions as edges: between its lines all functions are
  /// polynomials. No T-mesh itself: edges may end at crossings of extensions.
  std::vector<TFace> bezier_faces() const;

  /// The same edges on more lines: all that are here and any others, which divide edges and add none.
  /// @throws InvalidInput when one of ours is missing.
  TMesh on_lines(std::array<std::vector<double>, 2> lines) const;
  /// The same with lines at further knots; those within a billionth of the domain of a line are there.
  TMesh with_knots(const std::array<std::vector<double>, 2>& knots) const;
  /// The line of a knot. @throws InvalidInput when there is none.
  int find_line(int axis, double knot) const;
  /// The same lines with the borders' edges only.
  TMesh without_inner_edges() const;
  /// The same edges without the lines that have none.
  TMesh without_empty_lines() const;
  /// Adds an edge; where it reaches the inner border line it is led to the border. The mesh may be invalid
  /// until all are added: `check` says so.
  void add(const TSegment& segment);
  /// Adds the edge along `axis` through a point, as far as the next edges across on both sides; from a
  /// point on an edge across, to one side only: the larger one, unless the mesh ends there.
  void add_through(int axis, TPoint at);
  /// @throws InvalidInput as the constructor.
  void check() const;

  bool operator==(const TMesh&) const = default;

 private:
  std::size_t number(TPoint at) const {
    return static_cast<std::size_t>(at[1]) * num_lines(0) + at[0];
  }
  std::vector<TFace> faces_between(const std::array<std::vector<std::uint8_t>, 2>& edges) const;

  int degree_;
  std::array<std::vector<double>, 2> lines_;
  std::array<std::vector<std::uint8_t>, 2> edges_;  // [axis][number of the edge's first point]
};

/// The mesh with further edges that make its faces rectangles: loose ends and corners are led on to the next
/// edge, corners the shorter way.
TMesh rectangular(TMesh mesh);

/// The mesh with further edges that make it analysis-suitable: of two T-junctions whose extensions meet, the
/// one that is sooner past the crossing is moved on over the gap to the next edge, until none meet.
TMesh analysis_suitable(TMesh mesh);

}  // namespace crease

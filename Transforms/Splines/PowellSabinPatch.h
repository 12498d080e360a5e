#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "Core/Point.h"

namespace crease {

/// What the local functions of a vertex are there: column = function, rows = value, d/dx, d/dy.
using PowellSabinJets = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 4>;

/// The functions that do not vanish on one triangle, as quadratics on its six small triangles.
///
/// A function with value f and gradient g at corner V has the Bezier ordinates f at V, f + g . (R - V) / 2 half
/// way to an edge point R and f + g . (Z - V) / 2 half way to the centre Z; where R = l V_a + m V_b, and
/// Z = sum a_i V_i, the remaining ordinates are the same means of their neighbours, which makes it C1
/// in the triangle.
///
/// Source: P. Dierckx, "On calculating normalized Powell-Sabin B-splines", CAGD 15, 1997.
class PowellSabinPatch {
 public:
  static constexpr int kNumCells = 6;
  /// Most functions of a patch: four at each corner.
  static constexpr int kMaxFunctions = 12;
  using PerFunction =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxFunctions, 6>;

  /// What a patch is made of.
  struct Parts {
    std::array<Point<2>, 3> corners;      ///< counter-clockwise, mm
    std::array<Point<2>, 3> edge_points;  ///< of the edges from corner k to k + 1
    std::array<double, 3> shares;         ///< of corner k in edge point k
    Point<2> centre;
    Vector<3> centre_weights;
    std::array<PowellSabinJets, 3> jets;                      ///< at the corners, one-sided
    std::array<std::array<PowellSabinJets, 2>, 3> edge_jets;  ///< of corner k, k + 1 for the edge
    std::array<int, 3> first_control_point;                   ///< of each corner; others follow
    /// Of the cells: 0 none, 1 in the band of a crease with a body, 2 of one without.
    std::array<int, 6> bands;
  };
  explicit PowellSabinPatch(const Parts& parts);

  /// Their control points, ascending.
  std::span<const int> control_points() const { return control_points_; }
  int num_functions() const { return static_cast<int>(control_points_.size()); }
  /// The small triangles, counter-clockwise: 2k has corner k, edge point k and the centre; 2k + 1 has edge
  /// point k, corner k + 1 and the centre.
  std::array<Point<2>, 3> cell(int number) const;
  /// The one that holds u, or is nearest to it; the lowest number on ties.
  int find_cell(const Point<2>& u) const;
  int band(int cell) const { return bands_[cell]; }
  bool has_band(int band) const {
    return std::find(bands_.begin(), bands_.end(), band) != bands_.end();
  }
  /// The polynomials of a cell at u, whether it holds u or not: rows = functions; columns = values, then
  /// (derivatives >= 1) d/dx, d/dy, then (derivatives = 2) xx, xy, yy.
  PerFunction evaluate(int cell, const Point<2>& u, int derivatives) const;

 private:
  // Numbers of the six ordinates of a cell: at its corners, then at the middles of edges 01, 12, 20.
  static std::array<int, 6> ordinates_of(int cell);

  std::vector<int> control_points_;
  std::array<int, kNumCells> bands_;
  std::array<Point<2>, 7> points_;  // corners, edge points, centre
  // Per function: at corners 0-2, from corner k towards edge point k 3-5 and k - 1 6-8, towards the
  // centre 9-11, at the edge points 12-14, between them and the centre 15-17, at the centre 18.
  Eigen::Matrix<double, Eigen::Dynamic, 19, Eigen::ColMajor, kMaxFunctions, 19> ordinates_;
};

}  // namespace crease

#include "Transforms/Splines/PowellSabinPatch.h"

#include <algorithm>
#include <numeric>

#include "Transforms/Domains/Polygon.h"
#include "Transforms/Domains/SimplexMesh.h"
#include "Transforms/Splines/SimplexSpline.h"

namespace crease {
namespace {

// Twice the areas of the triangles that u makes with the sides opposite: barycentric but for a factor.
Vector<3> areas(const std::array<Point<2>, 3>& cell, const Point<2>& u) {
  return {cross(cell[2] - cell[1], u - cell[1]), cross(cell[0] - cell[2], u - cell[2]),
          cross(cell[1] - cell[0], u - cell[0])};
}

constexpr int kCentrePoint = 6;

// Of a cell's corners among the corners, edge points and centre.
std::array<int, 3> points_of(int cell) {
  const int side = cell / 2;
  return cell % 2 == 0 ? std::array{side, 3 + side, kCentrePoint}
                       : std::array{3 + side, (side + 1) % 3, kCentrePoint};
}

}  // namespace

PowellSabinPatch::PowellSabinPatch(const Parts& parts) : bands_(parts.bands) {
  for (int k = 0; k < 3; ++k) {
    points_[k] = parts.corners[k];
    points_[3 + k] = parts.edge_points[k];
  }
  points_[kCentrePoint] = parts.centre;

  std::array<int, 3> by_control_point = {0, 1, 2};
  std::sort(by_control_point.begin(), by_control_point.end(), [&](int a, int b) {
    return parts.first_control_point[a] < parts.first_control_point[b];
  });
  Eigen::Index count = 0;
  for (const auto& jets : parts.jets) count += jets.cols();
  ordinates_.setZero(count, 19);
  Eigen::Index first = 0;
  for (int k : by_control_point) {
    const Eigen::Index number = parts.jets[k].cols();
    for (Eigen::Index j = 0; j < number; ++j) {
      control_points_.push_back(parts.first_control_point[k] + static_cast<int>(j));
    }
    const auto towards = [&](const PowellSabinJets& jets, const Point<2>& q) {
      const Vector<2> half = 0.5 * (q - parts.corners[k]);
      return (jets.transpose() * Vector<3>(1, half.x(), half.y())).eval();
    };
    const int before = (k + 2) % 3;
    auto own = ordinates_.middleRows(first, number);
    own.col(k) = parts.jets[k].row(0).transpose();
    own.col(3 + k) = towards(parts.edge_jets[k][0], parts.edge_points[k]);
    own.col(6 + k) = towards(parts.edge_jets[before][1], parts.edge_points[before]);
    own.col(9 + k) = towards(parts.jets[k], parts.centre);
    first += number;
  }
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const double l = parts.shares[k];
    ordinates_.col(12 + k) = l * ordinates_.col(3 + k) + (1 - l) * ordinates_.col(6 + next);
    ordinates_.col(15 + k) = l * ordinates_.col(9 + k) + (1 - l) * ordinates_.col(9 + next);
  }
  ordinates_.col(18) = ordinates_.middleCols<3>(9) * parts.centre_weights;
}

std::array<int, 6> PowellSabinPatch::ordinates_of(int cell) {
  const int side = cell / 2, next = (side + 1) % 3;
  return cell % 2 == 0 ? std::array{side, 12 + side, 18, 3 + side, 15 + side, 9 + side}
                       : std::array{12 + side, next, 18, 6 + next, 9 + next, 15 + side};
}

std::array<Point<2>, 3> PowellSabinPatch::cell(int number) const {
  const auto [a, b, c] = points_of(number);
  return {points_[a], points_[b], points_[c]};
}

int PowellSabinPatch::find_cell(const Point<2>& u) const {
  int best = 0;
  double most = 0;
  for (int c = 0; c < kNumCells; ++c) {
    const auto corners = cell(c);
    const double least = areas(corners, u).minCoeff() / signed_content<2>(corners);
    if (c > 0 && !(least > most)) continue;
    best = c;
    most = least;
  }
  return best;
}

// With t the barycentric coordinates and M the symmetric matrix of ordinates, f = t^T M t,
// grad f = 2 sum_i (M t)_i grad t_i, Hess f = 2 sum_ij M_ij grad t_i grad t_j^T.
PowellSabinPatch::PerFunction PowellSabinPatch::evaluate(int cell_number, const Point<2>& u,
                                                         int derivatives) const {
  const auto corners = cell(cell_number);
  const auto numbers = ordinates_of(cell_number);
  const Vector<3> t = areas(corners, u) / signed_content<2>(corners);
  constexpr int kColumns[3] = {1, 3, 6};
  PerFunction result(num_functions(), kColumns[derivatives]);
  const auto ordinate = [&](int k) { return ordinates_.col(numbers[k]); };
  result.col(0) =
      t[0] * t[0] * ordinate(0) + t[1] * t[1] * ordinate(1) + t[2] * t[2] * ordinate(2) +
      2 * (t[0] * t[1] * ordinate(3) + t[1] * t[2] * ordinate(4) + t[2] * t[0] * ordinate(5));
  if (derivatives == 0) return result;

  const Eigen::Matrix<double, 2, 3> g = barycentric_gradients<2>(corners);
  constexpr int kOrdinate[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  result.rightCols(kColumns[derivatives] - 1).setZero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto m = ordinate(kOrdinate[i][j]);
      for (int a = 0; a < 2; ++a) result.col(1 + a) += 2 * t[j] * g(a, i) * m;
      if (derivatives < 2) continue;
      result.col(3) += 2 * g(0, i) * g(0, j) * m;
      result.col(4) += 2 * g(0, i) * g(1, j) * m;
      result.col(5) += 2 * g(1, i) * g(1, j) * m;
    }
  }
  return result;
}

}  // namespace crease

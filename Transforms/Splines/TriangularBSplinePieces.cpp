#include "Transforms/Splines/TriangularBSplinePieces.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "Core/Parallel.h"
#include "Transforms/Splines/KnotLocator.h"

namespace crease {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// By how much of the largest the evaluated gradients of functions may be wrong: ten times what tests against
/// values of 50 digits find.
constexpr double kGradientAccuracy = 1e-12;

double polar_determinant(const Matrix<2>& m, const Matrix<2>& n) {
  return 0.5 * (m(0, 0) * n(1, 1) + n(0, 0) * m(1, 1) - m(0, 1) * n(1, 0) - n(0, 1) * m(1, 0));
}

}  // namespace

/// Points of one triangle's cells, and grad T there.
struct TriangularBSplinePieces::Nodes {
  std::vector<Point<2>> points;
  std::vector<Point<2>> sides;  // the centroid of the point's cell
  std::vector<Matrix<2>> jacobians;
  std::vector<double> errors;

  int add(const Point<2>& point, const Point<2>& side) {
    points.push_back(point);
    sides.push_back(side);
    return static_cast<int>(points.size()) - 1;
  }
};

TriangularBSplinePieces::TriangularBSplinePieces(const KnotNet<2>& net,
                                                 const KnotControlPoints<2>& control_points,
                                                 const TriangularBSplineEvaluator& evaluator,
                                                 const KnotCells& cells,
                                                 const ControlPoints<2>& phi,
                                                 const Matrix<2>& linear)
    : net_(net),
      control_points_(control_points),
      evaluator_(evaluator),
      cells_(cells),
      phi_(phi),
      linear_(linear),
      tie_(kKnotTie * mesh_scale(net.mesh)),
      gammas_(multi_indices<2>(net.degree - 1)),
      neighbours_(vertex_neighbours(net.mesh)),
      gradients_(net.mesh.simplices.size() * gammas_.size()),
      errors_(net.mesh.simplices.size(), 0.0) {
  for (int t = 0; t < num_patches(); ++t) set_gradients(t);
}

void TriangularBSplinePieces::set_gradients(int triangle) {
  const auto clouds = simplex_clouds(net_, triangle);
  const auto points = control_points_.of_simplex(triangle);
  for (std::size_t g = 0; g < gammas_.size(); ++g) {
    const auto& gamma = gammas_[g];
    Point<2> x[3];
    Vector<2> c[3];
    for (int j = 0; j < 3; ++j) {
      auto beta = gamma;
      ++beta[j];
      x[j] = clouds[j][gamma[j]];
      c[j] = phi_.col(points[multi_index_position<2>(beta)]);
    }
    const Vector<2> first = x[1] - x[0], second = x[2] - x[0];
    const double content = cross(first, second);
    const double n = net_.degree / content;
    const Vector<2> slope1 = n * Vector<2>(second.y(), -second.x()),
                    slope2 = n * Vector<2>(-first.y(), first.x());
    gradients_[triangle * gammas_.size() + g] =
        linear_ + (c[1] - c[0]) * slope1.transpose() + (c[2] - c[0]) * slope2.transpose();
    // Differences of knots and control points are exact to epsilon, their cross product to this many.
    const double condition = 4 * (1 + first.norm() * second.norm() / content);
    const double error = condition * kEpsilon *
                         (linear_.norm() + (c[1] - c[0]).norm() * slope1.norm() +
                          (c[2] - c[0]).norm() * slope2.norm());
    errors_[triangle] = std::max(errors_[triangle], content > 0 ? error : kInfinity);
  }
}

// Of the neighbours' functions those are left out whose knots all lie beyond an edge of the triangle.
std::vector<Matrix<2>> TriangularBSplinePieces::gradient_hull(int triangle) const {
  const auto corners = simplex_corners(net_.mesh, triangle);
  std::array<KnotPlane<2>, 3> edges;
  for (int e = 0; e < 3; ++e) edges[e] = side_through(corners[e], corners[(e + 1) % 3]);
  std::vector<Matrix<2>> hull;
  std::array<std::array<std::array<double, kMaxSplineDegree>, 3>, 3>
      inside{};  // edge, corner, knots
  for (int other : neighbours_[triangle]) {
    const auto clouds = simplex_clouds(net_, other);
    for (int e = 0; e < 3; ++e) {
      for (int j = 0; j < 3; ++j) {
        double highest = -kInfinity;
        for (int i = 0; i < std::max(1, net_.degree); ++i) {
          highest = std::max(highest, edges[e].distance(clouds[j][i]));
          inside[e][j][i] = highest;
        }
      }
    }
    for (std::size_t g = 0; g < gammas_.size(); ++g) {
      const auto& gamma = gammas_[g];
      bool reaches = true;
      for (int e = 0; e < 3; ++e) {
        reaches = reaches && std::max({inside[e][0][gamma[0]], inside[e][1][gamma[1]],
                                       inside[e][2][gamma[2]]}) > tie_;
      }
      if (reaches) hull.push_back(gradients_[other * gammas_.size() + g]);
    }
  }
  return hull;
}

double TriangularBSplinePieces::rough_bound(int patch) const {
  const std::vector<Matrix<2>> hull = gradient_hull(patch);
  double least = kInfinity, largest = 0, error = 0;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    largest = std::max(largest, hull[k].cwiseAbs().maxCoeff());
    for (std::size_t l = 0; l <= k; ++l) {
      least = std::min(least, polar_determinant(hull[k], hull[l]));
    }
  }
  for (int other : neighbours_[patch]) error = std::max(error, errors_[other]);
  if (error == kInfinity) return -kInfinity;
  return least - determinant_error<2>(largest, error);
}

void TriangularBSplinePieces::evaluate(int triangle, Nodes& nodes) const {
  thread_local TriangularBSplineEvaluator::Scratch scratch;
  constexpr int kLanes = LanePoints::kMaxLanes;
  const Point<2> inside = simplex_centroid(net_.mesh, triangle);
  const int total = static_cast<int>(nodes.points.size());
  nodes.jacobians.assign(total, linear_);
  nodes.errors.assign(total, 0.0);
  LanePoints lanes;
  std::fill(lanes.inside_x, lanes.inside_x + kLanes, inside.x());
  std::fill(lanes.inside_y, lanes.inside_y + kLanes, inside.y());
  for (int begin = 0; begin < total; begin += kLanes) {
    const int used = std::min(kLanes, total - begin);
    for (int l = 0; l < used; ++l) {
      lanes.x[l] = nodes.points[begin + l].x();
      lanes.y[l] = nodes.points[begin + l].y();
      lanes.side_x[l] = nodes.sides[begin + l].x();
      lanes.side_y[l] = nodes.sides[begin + l].y();
    }
    fill_lanes(lanes, used);
    evaluator_.evaluate(lanes, {&triangle, 1}, 1, scratch);
    const auto found = scratch.control_points();
    // Gradients sum to 0: control points count from one of them.
    const Vector<2> origin = phi_.col(found[0]);
    double largest[kLanes] = {}, spread = 0;
    for (int f = 0; f < std::ssize(found); ++f) {
      const Vector<2> c = phi_.col(found[f]) - origin;
      const double *dx = scratch.lanes(f, 1), *dy = scratch.lanes(f, 2);
      spread += c.cwiseAbs().maxCoeff();
      for (int l = 0; l < used; ++l) {
        nodes.jacobians[begin + l].col(0) += dx[l] * c;
        nodes.jacobians[begin + l].col(1) += dy[l] * c;
        largest[l] = std::max({largest[l], std::abs(dx[l]), std::abs(dy[l])});
      }
    }
    for (int l = 0; l < used; ++l) {
      nodes.errors[begin + l] =
          kGradientAccuracy * (linear_.cwiseAbs().maxCoeff() + spread * largest[l]);
    }
  }
}

std::vector<DeterminantPiece<2>> TriangularBSplinePieces::pieces(int patch) const {
  const int degree = net_.degree - 1;
  const auto& indices = gammas_;
  Nodes nodes;
  struct Fan {
    std::array<Point<2>, 3> corners;
    std::vector<int> nodes;
  };
  std::vector<Fan> fans;
  for (const KnotCell& cell : cells_.of_triangle(patch)) {
    const KnotPolygon& polygon = cell.polygon;
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      Fan fan{{polygon[0], polygon[i - 1], polygon[i]}, {}};
      const auto points = domain_points<2>(fan.corners, degree);
      for (std::size_t b = 0; b < indices.size(); ++b) {
        const auto& beta = indices[b];
        // The diagonal that a triangle shares with the one before it.
        const bool known = i > 2 && beta[2] == 0;
        fan.nodes.push_back(known
                                ? fans.back().nodes[multi_index_position<2>({beta[0], 0, beta[1]})]
                                : nodes.add(points[b], cell.centroid));
      }
      fans.push_back(std::move(fan));
    }
  }
  evaluate(patch, nodes);

  std::vector<DeterminantPiece<2>> result;
  result.reserve(fans.size());
  std::vector<Matrix<2>> values(indices.size());
  for (const Fan& fan : fans) {
    double error = 0;
    for (std::size_t b = 0; b < values.size(); ++b) {
      values[b] = nodes.jacobians[fan.nodes[b]];
      error = std::max(error, nodes.errors[fan.nodes[b]]);
    }
    result.emplace_back(simplex_piece<2>(fan.corners, degree, values, error));
  }
  return result;
}

}  // namespace crease

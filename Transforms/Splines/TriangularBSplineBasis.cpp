#include "Transforms/Splines/TriangularBSplineBasis.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "Core/Error.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/Domains/KnotNetCheck.h"
#include "Transforms/Domains/MeshEdges.h"
#include "Transforms/Splines/KnotBorder.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/SimplexSplineGraph.h"
#include "Transforms/Splines/TriangularBSplineEvaluator.h"
#include "Transforms/Splines/TriangularBSplineGrid.h"
#include "Transforms/Splines/TriangularBSplinePieces.h"
#include "Transforms/Splines/TriangularBSplineQuadrature.h"
#include "Transforms/Splines/TriangularBSplineSampler.h"

namespace crease {
namespace {

template <int Dim>
KnotNet<Dim> checked(KnotNet<Dim> net) {
  validate<Dim>(net);
  std::vector<char> used(net.mesh.vertices.size(), 0);
  for (const auto& simplex : net.mesh.simplices) {
    for (int v : simplex) used[v] = 1;
  }
  if (const auto v = std::find(used.begin(), used.end(), 0); v != used.end()) {
    throw InvalidInput(
        message("knot net: vertex ", v - used.begin(), " belongs to no simplex; leave it out."));
  }
  return net;
}

// Functions in ascending order of their control points; jet(function, quantity) gives their values,
// then first, then second derivatives.
template <int Dim, typename Jet>
BasisValues<Dim> sorted_values(std::span<const int> control_points, std::span<const int> order,
                               int derivatives, const Jet& jet) {
  const auto count = static_cast<Eigen::Index>(order.size());
  BasisValues<Dim> result;
  result.control_points.resize(order.size());
  result.values.resize(count);
  if (derivatives > 0) result.gradients.resize(Dim, count);
  if (derivatives > 1) result.hessians.resize(kNumSecondDerivatives<Dim>, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int f = order[i];
    result.control_points[i] = control_points[f];
    result.values[i] = jet(f, 0);
    for (int a = 0; a < Dim && derivatives > 0; ++a) result.gradients(a, i) = jet(f, 1 + a);
    for (int a = 0; a < kNumSecondDerivatives<Dim> && derivatives > 1; ++a) {
      result.hessians(a, i) = jet(f, 1 + Dim + a);
    }
  }
  return result;
}

std::vector<int> ascending_order(std::span<const int> control_points) {
  std::vector<int> order(control_points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return control_points[a] < control_points[b]; });
  return order;
}

// By the pyramids and edge terms of the triangles near x.
BasisValues<2> values_near(const TriangularBSplineEvaluator& evaluator, const KnotNet<2>& net,
                           const Point<2>& x, int triangle, int derivatives) {
  thread_local TriangularBSplineEvaluator::Scratch scratch;
  LanePoints lanes;
  const Point<2> inside = simplex_centroid(net.mesh, triangle);
  lanes.x[0] = lanes.side_x[0] = x.x();
  lanes.y[0] = lanes.side_y[0] = x.y();
  lanes.inside_x[0] = inside.x();
  lanes.inside_y[0] = inside.y();
  fill_lanes(lanes, 1);
  evaluator.evaluate(lanes, {&triangle, 1}, derivatives, scratch);
  const auto found = scratch.control_points();
  return sorted_values<2>(found, ascending_order(found), derivatives,
                          [&](int f, int quantity) { return scratch.lanes(f, quantity)[0]; });
}

// By the graph of simplex splines; functions of neighbours with one control point add up.
BasisValues<3> values_near(const SimplexSplineGraph<3>& graph, const KnotNet<3>& net,
                           const KnotControlPoints<3>& control_points,
                           std::span<const int> neighbours, const Point<3>& x, int tetrahedron,
                           int derivatives) {
  const auto flag = flag_towards<3>(simplex_centroid(net.mesh, tetrahedron), x);
  std::map<int, SplineJet<3>> sums;
  for (const auto& f : graph.evaluate(x, flag, neighbours, derivatives)) {
    SplineJet<3>& sum = sums[control_points.of_simplex(f.simplex)[f.index]];
    sum.value += f.jet.value;
    sum.gradient += f.jet.gradient;
    sum.hessian += f.jet.hessian;
  }
  std::vector<int> numbers;
  std::vector<SplineJet<3>> jets;
  for (const auto& [number, jet] : sums) {
    numbers.push_back(number);
    jets.push_back(jet);
  }
  return sorted_values<3>(numbers, ascending_order(numbers), derivatives, [&](int f, int quantity) {
    if (quantity == 0) return jets[f].value;
    return quantity <= 3 ? jets[f].gradient[quantity - 1] : jets[f].hessian[quantity - 4];
  });
}

}  // namespace

template <int Dim>
TriangularBSplineBasis<Dim>::TriangularBSplineBasis(KnotNet<Dim> net)
    : net_(checked(std::move(net))),
      control_points_(net_.mesh, net_.degree),
      border_(net_.mesh, border_facets<Dim>(net_.mesh)),
      tie_(kKnotTie * mesh_scale(net_.mesh)),
      mean_edge_length_(crease::mean_edge_length(net_.mesh)) {
  locator_ = std::make_unique<KnotLocator<Dim>>(net_.mesh, tie_);
  const int count = static_cast<int>(net_.mesh.simplices.size());
  for (int s = 0; s < count; ++s) {
    patches_.emplace_back(simplex_clouds(net_, s), net_.degree);
    ascending_.push_back(ascending_order(control_points_.of_simplex(s)));
    measure_ += signed_content<Dim>(simplex_corners(net_.mesh, s)) / (Dim == 2 ? 2 : 6);
  }
  if constexpr (Dim == 2) {
    evaluator_ = std::make_unique<TriangularBSplineEvaluator>(net_, control_points_);
    quadrature_ = std::make_unique<TriangularBSplineQuadrature>(net_, control_points_, *evaluator_);
  } else {
    graph_ = std::make_unique<SimplexSplineGraph<Dim>>(net_.mesh, net_.clouds, net_.degree);
    neighbours_ = vertex_neighbours(net_.mesh);
  }
}

template <int Dim>
TriangularBSplineBasis<Dim>::~TriangularBSplineBasis() = default;

template <int Dim>
int TriangularBSplineBasis<Dim>::smoothness() const {
  int most = 0;  // multiplicity of a knot, collapsed clouds (corners of creases) left out
  for (const auto& cloud : net_.clouds) {
    const auto same = [&](const Point<Dim>& a, const Point<Dim>& b) {
      return (a - b).norm() <= 0.1 * tie_;
    };
    const bool collapsed = std::all_of(
        cloud.begin(), cloud.end(), [&](const Point<Dim>& knot) { return same(knot, cloud[0]); });
    if (collapsed && net_.degree > 1) continue;
    for (const auto& knot : cloud) {
      most = std::max(most, static_cast<int>(std::count_if(
                                cloud.begin(), cloud.end(),
                                [&](const Point<Dim>& other) { return same(knot, other); })));
    }
  }
  return most == 0 ? 0 : net_.degree - most;
}

template <int Dim>
Box<Dim> TriangularBSplineBasis<Dim>::bounds() const {
  return locator_->bounds();
}

template <int Dim>
double TriangularBSplineBasis<Dim>::edge_length(const Point<Dim>& x) const {
  const int simplex = find_simplex(x);
  return simplex < 0 ? mean_edge_length_ : crease::mean_edge_length(net_.mesh, simplex);
}

template <int Dim>
int TriangularBSplineBasis<Dim>::find_simplex(const Point<Dim>& x) const {
  return locator_->find(x);
}

template <int Dim>
bool TriangularBSplineBasis<Dim>::in_core(int simplex, const Point<Dim>& x) const {
  return patches_[simplex].in_core(x, tie_);
}

template <int Dim>
Point<Dim> TriangularBSplineBasis<Dim>::nearest_point(const Point<Dim>& x) const {
  return contains(x) ? x : border_.find(x).point;
}

template <int Dim>
Eigen::VectorXd TriangularBSplineBasis<Dim>::control_values(
    const PolarForm<Dim>& polar_form) const {
  Eigen::VectorXd values(num_control_points());
  std::vector<Point<Dim>> arguments;
  for (int i = 0; i < num_control_points(); ++i) {
    const auto& owner = control_points_.owner(i);
    arguments.clear();
    for (int j = 0; j <= Dim; ++j) {
      const auto& cloud = net_.clouds[net_.mesh.simplices[owner.simplex][j]];
      arguments.insert(arguments.end(), cloud.begin(), cloud.begin() + owner.beta[j]);
    }
    values[i] = polar_form(arguments);
  }
  return values;
}

template <int Dim>
ControlPoints<Dim> TriangularBSplineBasis<Dim>::greville_points() const {
  ControlPoints<Dim> points(Dim, num_control_points());
  for (int a = 0; a < Dim; ++a) {
    points.row(a) = control_values([&](std::span<const Point<Dim>> arguments) {
      double sum = 0.0;
      for (const auto& knot : arguments) sum += knot[a];
      return sum / net_.degree;
    });
  }
  return points;
}

template <int Dim>
BasisValues<Dim> TriangularBSplineBasis<Dim>::evaluate(const Point<Dim>& x, int derivatives) const {
  const int simplex = find_simplex(x);
  if (simplex < 0) {
    throw InvalidInput(message("TriangularBSplineBasis: the point (", x.transpose(),
                               ") mm lies outside the domain; use nearest_point() first."));
  }
  if (in_core(simplex, x)) {
    const auto jets = patches_[simplex].evaluate(x, derivatives);
    return sorted_values<Dim>(control_points_.of_simplex(simplex), ascending_[simplex], derivatives,
                              [&](int f, int quantity) { return jets(f, quantity); });
  }
  if constexpr (Dim == 2) {
    return values_near(*evaluator_, net_, x, simplex, derivatives);
  } else {
    return values_near(*graph_, net_, control_points_, neighbours_[simplex], x, simplex,
                       derivatives);
  }
}

template <int Dim>
std::unique_ptr<SplineSampler<Dim>> TriangularBSplineBasis<Dim>::sampler(
    const Eigen::Ref<const Eigen::MatrixXd>& control_points) const {
  if constexpr (Dim == 3) {
    return nullptr;
  } else {
    return std::make_unique<TriangularBSplineSampler>(*this, *evaluator_, border_, control_points);
  }
}

template <int Dim>
std::vector<QuadratureElement<Dim>> TriangularBSplineBasis<Dim>::quadrature(
    int polynomial_degree, int derivatives,
    const std::function<bool(int region, int patch)>& wanted) const {
  if constexpr (Dim == 3) {
    throw InvalidInput(
        "TriangularBSplineBasis: integrals over tetrahedral B-splines in 3D come in a later "
        "version; use "
        "a tensor-product B-spline in 3D.");
  } else {
    std::vector<int> chosen;
    for (int t = 0; t < static_cast<int>(net_.mesh.simplices.size()); ++t) {
      if (!wanted || wanted(net_.mesh.region(t), t)) chosen.push_back(t);
    }
    return quadrature_->elements(chosen, polynomial_degree, derivatives);
  }
}

template <int Dim>
std::vector<std::pair<int, int>> TriangularBSplineBasis<Dim>::couplings() const {
  if constexpr (Dim == 2) {
    return overlapping_functions(net_, control_points_);
  } else {
    std::vector<std::pair<int, int>> pairs;  // all functions of simplices that share a vertex
    for (std::size_t s = 0; s < neighbours_.size(); ++s) {
      for (int other : neighbours_[s]) {
        for (int i : control_points_of(static_cast<int>(s))) {
          for (int k : control_points_of(other)) {
            if (i <= k) pairs.emplace_back(i, k);
          }
        }
      }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
  }
}

template <int Dim>
std::unique_ptr<DeterminantPieces<Dim>> TriangularBSplineBasis<Dim>::determinant_pieces(
    const ControlPoints<Dim>& phi, const Matrix<Dim>& linear) const {
  if constexpr (Dim == 3) {
    return nullptr;
  } else {
    return std::make_unique<TriangularBSplinePieces>(net_, control_points_, *evaluator_,
                                                     quadrature_->cells(), phi, linear);
  }
}

template <int Dim>
std::unique_ptr<BoundGrid<Dim>> TriangularBSplineBasis<Dim>::bind(const Raster<Dim>& raster) const {
  if constexpr (Dim == 3) {
    throw InvalidInput(
        "TriangularBSplineBasis: rasters for tetrahedral B-splines in 3D come in a later version; "
        "use a tensor-product B-spline in 3D.");
  } else {
    return std::make_unique<TriangularBSplineGrid>(*this, *evaluator_, raster);
  }
}

template class TriangularBSplineBasis<2>;
template class TriangularBSplineBasis<3>;

}  // namespace crease

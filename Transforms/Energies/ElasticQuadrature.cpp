#include "Transforms/Energies/ElasticQuadrature.h"

#include <algorithm>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/Splines/KnotCellRule.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

constexpr int kRuleDegree = 6;  // of Dunavant's rule of 12 points

/// Joins the functions that do not vanish at some of the points.
void set_functions(const std::vector<BasisValues<2>>& at_points, QuadratureElement<2>& element) {
  auto& functions = element.control_points;
  for (const auto& found : at_points) {
    functions.insert(functions.end(), found.control_points.begin(), found.control_points.end());
  }
  std::ranges::sort(functions);
  functions.erase(std::unique(functions.begin(), functions.end()), functions.end());
  const auto k = std::ssize(functions), q = std::ssize(at_points);
  element.values.setZero(k, q);
  element.gradients.assign(2, Eigen::MatrixXd::Zero(k, q));
  for (std::int64_t p = 0; p < q; ++p) {
    const BasisValues<2>& found = at_points[static_cast<std::size_t>(p)];
    for (std::size_t i = 0; i < found.control_points.size(); ++i) {
      const auto row = std::ranges::lower_bound(functions, found.control_points[i]);
      const auto n = row - functions.begin();
      const auto column = static_cast<Eigen::Index>(i);
      element.values(n, p) = found.values[column];
      for (int a = 0; a < 2; ++a) element.gradients[a](n, p) = found.gradients(a, column);
    }
  }
}

QuadratureElement<2> element_of(const TriangularBSplineBasis<2>& basis, int triangle) {
  const SimplexMesh<2>& mesh = basis.net().mesh;
  const auto corners = simplex_corners(mesh, triangle);
  const TriangleRule& rule = triangle_rule(kRuleDegree);
  const auto q = std::ssize(rule.points);
  QuadratureElement<2> element;
  element.patch = triangle;
  element.region = mesh.region(triangle);
  element.points.resize(2, q);
  element.weights.resize(q);
  const double area = 0.5 * signed_content<2>(corners);
  std::vector<BasisValues<2>> at_points;
  for (std::int64_t p = 0; p < q; ++p) {
    const auto& weights = rule.points[static_cast<std::size_t>(p)];
    const Point<2> x = weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
    element.points.col(p) = x;
    element.weights[p] = area * rule.weights[static_cast<std::size_t>(p)];
    at_points.push_back(basis.evaluate(x, 1));
  }
  set_functions(at_points, element);
  return element;
}

}  // namespace

template <int Dim>
std::vector<QuadratureElement<Dim>> cheap_elements(const SplineBasis<Dim>& basis) {
  const auto* triangular = dynamic_cast<const TriangularBSplineBasis<Dim>*>(&basis);
  if (Dim == 3 || triangular == nullptr) {
    throw InvalidInput("cheap quadrature: the domain has no triangles; integrate by cells.");
  }
  std::vector<QuadratureElement<Dim>> elements;
  if constexpr (Dim == 2) {
    elements.resize(triangular->net().mesh.simplices.size());
    parallel_for(std::ssize(elements), [&](std::int64_t t) {
      elements[static_cast<std::size_t>(t)] = element_of(*triangular, static_cast<int>(t));
    });
  }
  return elements;
}

template std::vector<QuadratureElement<2>> cheap_elements<2>(const SplineBasis<2>&);
template std::vector<QuadratureElement<3>> cheap_elements<3>(const SplineBasis<3>&);

}  // namespace crease

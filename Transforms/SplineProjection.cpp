#include "Transforms/SplineProjection.h"

#include <Eigen/SparseCholesky>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/Energies/ScalarAssembly.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

template <int Dim>
bool same_lattice(const TensorLattice<Dim>& a, const TensorLattice<Dim>& b) {
  return a.spans == b.spans && a.spacing.isApprox(b.spacing, 1e-12) &&
         a.direction.isApprox(b.direction, 1e-12) &&
         (a.origin - b.origin).norm() <= 1e-12 * (a.spacing.norm() + a.origin.norm());
}

/// Knot insertion until the lattice is that of `to`; empty when it never is.
template <int Dim>
ControlPoints<Dim> insert_knots(const SplineBasis<Dim>& from, const ControlPoints<Dim>& points,
                                const SplineBasis<Dim>& to) {
  const auto* coarse = dynamic_cast<const TensorBSplineBasis<Dim>*>(&from);
  const auto* fine = dynamic_cast<const TensorBSplineBasis<Dim>*>(&to);
  if (!coarse || !fine || coarse->degree() != fine->degree()) return {};
  TensorBSplineBasis<Dim> basis = *coarse;
  ControlPoints<Dim> result = points;
  while (basis.lattice().spans[0] < fine->lattice().spans[0]) {
    result = basis.refine_control_points(result);
    basis = basis.refined();
  }
  return same_lattice(basis.lattice(), fine->lattice()) ? result : ControlPoints<Dim>();
}

}  // namespace

template <int Dim>
ProjectionSystem<Dim> projection_system(const SplineBasis<Dim>& basis,
                                        const DisplacementFunction<Dim>& displacement) {
  ProjectionSystem<Dim> system{mass_matrix(basis),
                               ControlPoints<Dim>::Zero(Dim, basis.num_control_points())};
  visit_quadrature<Dim>(basis, basis.product_degree(2, 0), 0, nullptr, [&](auto& elements) {
    std::vector<ControlPoints<Dim>> parts(elements.size());
    parallel_for(std::ssize(elements), [&](std::int64_t e) {
      const auto& element = elements[e];
      ControlPoints<Dim> u(Dim, element.weights.size());
      for (Eigen::Index q = 0; q < u.cols(); ++q) {
        u.col(q) = element.weights[q] * displacement(element.points.col(q));
      }
      parts[e] = u * element.values.transpose();
    });
    for (std::size_t e = 0; e < elements.size(); ++e) {
      for (std::size_t i = 0; i < elements[e].control_points.size(); ++i) {
        system.rhs.col(elements[e].control_points[i]) += parts[e].col(i);
      }
    }
  });
  return system;
}

template <int Dim>
SplineProjection<Dim> projection_error(const SplineBasis<Dim>& basis,
                                       const ControlPoints<Dim>& control_points,
                                       const DisplacementFunction<Dim>& displacement) {
  SplineProjection<Dim> result;
  result.control_points = control_points;
  double integral = 0;
  visit_quadrature<Dim>(basis, basis.product_degree(2, 0), 0, nullptr, [&](auto& elements) {
    std::vector<std::pair<double, double>> parts(elements.size());  // integral, largest square
    parallel_for(std::ssize(elements), [&](std::int64_t e) {
      const auto& element = elements[e];
      const ControlPoints<Dim> u =
          control_points(Eigen::all, element.control_points) * element.values;
      for (Eigen::Index q = 0; q < u.cols(); ++q) {
        const double square = (u.col(q) - displacement(element.points.col(q))).squaredNorm();
        parts[e].first += element.weights[q] * square;
        parts[e].second = std::max(parts[e].second, square);
      }
    });
    for (const auto& [part, largest] : parts) {
      integral += part;
      result.max_error = std::max(result.max_error, std::sqrt(largest));
    }
  });
  result.rms_error = std::sqrt(integral / basis.measure());
  return result;
}

template <int Dim>
SplineProjection<Dim> project(const SplineBasis<Dim>& basis,
                              const DisplacementFunction<Dim>& displacement) {
  const auto system = projection_system(basis, displacement);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(system.mass);
  if (factor.info() != Eigen::Success) {
    throw SolverError("project: the mass matrix of the spline basis is singular.");
  }
  const Eigen::MatrixXd solution = factor.solve(system.rhs.transpose());
  if (!solution.allFinite()) throw SolverError("project: the fit is not finite.");
  return projection_error<Dim>(basis, solution.transpose(), displacement);
}

template <int Dim>
SplineProjection<Dim> transfer(const std::shared_ptr<const SplineBasis<Dim>>& from,
                               const ControlPoints<Dim>& control_points,
                               const SplineBasis<Dim>& to) {
  SplineTransform<Dim> spline(from);
  spline.set_control_points(control_points);
  SplineProjection<Dim> exact;
  exact.control_points = insert_knots<Dim>(*from, control_points, to);
  if (exact.control_points.size() > 0) return exact;
  return project<Dim>(to, [&](const Point<Dim>& x) -> Vector<Dim> { return spline.map(x) - x; });
}

#define CREASE_INSTANTIATE(Dim)                                                              \
  template ProjectionSystem<Dim> projection_system(const SplineBasis<Dim>&,                  \
                                                   const DisplacementFunction<Dim>&);        \
  template SplineProjection<Dim> projection_error(                                           \
      const SplineBasis<Dim>&, const ControlPoints<Dim>&, const DisplacementFunction<Dim>&); \
  template SplineProjection<Dim> project(const SplineBasis<Dim>&,                            \
                                         const DisplacementFunction<Dim>&);                  \
  template SplineProjection<Dim> transfer(const std::shared_ptr<const SplineBasis<Dim>>&,    \
                                          const ControlPoints<Dim>&, const SplineBasis<Dim>&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease

#pragma once

#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Splines/NurbsBasis.h"
#include "Transforms/Splines/TSplineRefinement.h"

namespace crease::testing {

/// Uneven knots over [0, spans], one of them repeated where the degree allows: 0 1.3 .. spans.
inline std::vector<double> uneven_knots(int degree, int spans, double size) {
  std::vector<double> knots(static_cast<std::size_t>(degree) + 1, 0.0);
  for (int s = 1; s < spans; ++s) {
    const double knot = (s + 0.3 * std::sin(2.0 * s)) * size / spans;
    for (int n = 0; n < (s == 2 ? std::min(2, degree) : 1); ++n) knots.push_back(knot);
  }
  knots.insert(knots.end(), static_cast<std::size_t>(degree) + 1, size);
  return knots;
}

/// Over the domain of a lattice.
template <int Dim>
NurbsNet<Dim> nurbs_net(const TensorLattice<Dim>& lattice, int degree) {
  NurbsNet<Dim> net;
  net.degree = degree;
  net.origin = lattice.origin;
  net.direction = lattice.direction;
  for (int a = 0; a < Dim; ++a) {
    net.knots[a] = uneven_knots(degree, lattice.spans[a], lattice.spans[a] * lattice.spacing[a]);
  }
  return net;
}

/// The same with weights that keep the affine maps, and vary by the share given.
template <int Dim>
NurbsNet<Dim> rational_net(const TensorLattice<Dim>& lattice, int degree, double share = 0.3) {
  NurbsNet<Dim> net = nurbs_net(lattice, degree);
  Eigen::Index count = 1;
  for (const auto& axis : weight_axes(net)) count *= axis.num_functions();
  const Eigen::VectorXd coefficients = 1 + Numbers(3).columns<1>(count, share).transpose().array();
  net.weights = elevated_weights(net, coefficients);
  return net;
}

/// Over the domain of a lattice, with finer faces round two places.
inline std::shared_ptr<const TSplineBasis> tspline(const TensorLattice<2>& lattice, int degree) {
  const TSplineBasis coarse(TMesh::tensor(KnotVector(degree, nurbs_net(lattice, degree).knots[0]),
                                          KnotVector(degree, nurbs_net(lattice, degree).knots[1])),
                            lattice.origin, lattice.direction);
  const Eigen::MatrixXd none(0, coarse.num_control_points());
  const int last = static_cast<int>(coarse.elements().size()) - 1;
  const auto once = refined(coarse, none, {last / 3, last / 2 + 1});
  return refined(*once.basis, once.control_points, {last / 3 + 1}).basis;
}

}  // namespace crease::testing

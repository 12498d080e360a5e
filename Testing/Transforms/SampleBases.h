#pragma once

#include <algorithm>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Testing/Transforms/SampleCentres.h"
#include "Testing/Transforms/SampleNurbs.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/Mesher.h"
#include "Transforms/Domains/TetrahedronKnots.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/PowellSabinCreases.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease::testing {

template <int Dim>
struct SampleBasis {
  std::string name;
  std::shared_ptr<const SplineBasis<Dim>> basis;
  bool integrates = true;  // has a quadrature, and so energies
};

template <int Dim>
TensorLattice<Dim> lattice_over(const Box<Dim>& box, int spans) {
  TensorLattice<Dim> lattice;
  lattice.spans.fill(spans);
  lattice.spacing = box.size() / spans;
  lattice.origin = box.lower;
  return lattice;
}

template <int Dim>
std::shared_ptr<const SplineBasis<Dim>> tensor_over(const Box<Dim>& box, int spans, int degree) {
  return std::make_shared<TensorBSplineBasis<Dim>>(lattice_over<Dim>(box, spans), degree);
}

/// 4 x 4 cells of two triangles.
inline std::shared_ptr<const SplineBasis<2>> triangles_over(const Box<2>& box,
                                                            const KnotOptions& options,
                                                            int cells = 4) {
  DomainMesh domain;
  domain.mesh = structured_triangulation(box, cells, cells);
  return std::make_shared<TriangularBSplineBasis<2>>(place_knots(domain, options).net);
}

/// A round body in the middle, a third of the box wide.
inline DomainMesh round_body_over(const Box<2>& box) {
  const double size = box.size().minCoeff();
  const Point<2> middle = 0.5 * (box.lower + box.upper);
  return mesh_domain(rectangle(box.lower[0], box.lower[1], box.upper[0], box.upper[1]),
                     {closed_line(regular_polygon(middle, size / 3, 12))},
                     {.edge_length = size / 3, .edge_length_near_lines = size / 6});
}

/// With a crease along the body's outline.
inline std::shared_ptr<const SplineBasis<2>> creased_over(const Box<2>& box, int degree = 3,
                                                          int smoothness = -1) {
  return std::make_shared<TriangularBSplineBasis<2>>(
      place_knots(round_body_over(box), {.degree = degree, .smoothness = smoothness}).net);
}

/// The same net with its vertices, triangles and their corners in another order.
inline KnotNet<2> renumbered(const KnotNet<2>& net) {
  const auto n = static_cast<int>(net.mesh.vertices.size());
  int factor = 7;
  while (std::gcd(factor, n) != 1) ++factor;
  const auto other = [&](int v) { return (factor * v + 3) % n; };
  KnotNet<2> result = net;
  for (int v = 0; v < n; ++v) {
    result.mesh.vertices[other(v)] = net.mesh.vertices[v];
    result.clouds[other(v)] = net.clouds[v];
  }
  std::ranges::reverse(result.mesh.simplices);
  std::ranges::reverse(result.mesh.regions);
  for (auto& s : result.mesh.simplices) s = {other(s[1]), other(s[2]), other(s[0])};
  for (auto& edge : result.crease_edges) {
    edge.vertices = {other(edge.vertices[1]), other(edge.vertices[0])};
  }
  return result;
}

/// Bases of every kind over a box.
template <int Dim>
std::vector<SampleBasis<Dim>> sample_bases(const Box<Dim>& box) {
  std::vector<SampleBasis<Dim>> bases = {{"tensor, quadratic", tensor_over<Dim>(box, 3, 2)},
                                         {"tensor, cubic", tensor_over<Dim>(box, 3, 3)},
                                         {"thin plates", thin_plates_over<Dim>(box, 3)}};
  const auto lattice = lattice_over<Dim>(box, 3);
  bases.push_back(
      {"NURBS, equal weights", std::make_shared<NurbsBasis<Dim>>(nurbs_net<Dim>(lattice, 2))});
  bases.push_back(
      {"NURBS, rational", std::make_shared<NurbsBasis<Dim>>(rational_net<Dim>(lattice, 2, 0.2))});
  if constexpr (Dim == 2) {
    bases.push_back({"triangles, quadratic", triangles_over(box, {.degree = 2})});
    bases.push_back({"triangles, cubic", triangles_over(box, {.degree = 3})});
    bases.push_back({"triangles, C1 cubic", triangles_over(box, {.degree = 3, .smoothness = 1})});
    bases.push_back({"triangles, quartic", triangles_over(box, {.degree = 4})});
    bases.push_back({"creased triangles", creased_over(box)});
    bases.push_back(
        {"Powell-Sabin", std::make_shared<PowellSabinBasis>(structured_triangulation(box, 4, 3))});
    bases.push_back({"creased Powell-Sabin",
                     std::make_shared<PowellSabinBasis>(place_powell_sabin(round_body_over(box)))});
    bases.push_back({"NURBS, rational cubic",
                     std::make_shared<NurbsBasis<2>>(rational_net<2>(lattice_over<2>(box, 4), 3))});
    bases.push_back({"T-spline, cubic", tspline(lattice_over<2>(box, 5), 3)});
  } else {
    bases.push_back({"tetrahedra, quadratic",
                     std::make_shared<TriangularBSplineBasis<3>>(
                         place_knots(structured_tetrahedra(box, {2, 2, 2}), {.degree = 2})),
                     false});
  }
  return bases;
}

}  // namespace crease::testing

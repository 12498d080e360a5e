#include "Registration/FinerPlaces.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "Core/Parallel.h"
#include "Registration/ImageTerm.h"
#include "Registration/ProbeGrid.h"
#include "Transforms/Energies/ScalarAssembly.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

constexpr double kSignificant = 8;    // densities of the noise: one probe in 3,000 by chance, in 2D
constexpr double kShareOfGain = 0.7;  // that the chosen places hold
constexpr double kLeastPixels = 1.5;  // between control points
constexpr double kLeastSoftShare = 0.8;  // of a probe, by weight

/// What probes feel of the bending energy.
template <int Dim>
struct ProbedBending {
  ControlPoints<Dim> force;    // int (1 - w)^2 u_st B_st
  Eigen::VectorXd stiffness;   // int (1 - w)^2 B_st B_st
  Eigen::VectorXd soft, mass;  // int (1 - w)^2 B and int B
};

/// Second derivatives xy, .. count twice.
template <int Dim>
Eigen::Matrix<double, kNumSecondDerivatives<Dim>, 1> multiplicities() {
  Eigen::Matrix<double, kNumSecondDerivatives<Dim>, 1> m;
  for (int a = 0, s = 0; a < Dim; ++a) {
    for (int b = a; b < Dim; ++b, ++s) m[s] = a == b ? 1 : 2;
  }
  return m;
}

template <int Dim>
struct ElementShare {
  std::vector<BasisValues<Dim>> probes;  // per point
  Eigen::VectorXd weights;               // w_q (1 - w)^2, 0 in bands
  std::vector<Eigen::Matrix<double, Dim, kNumSecondDerivatives<Dim>>> bending;  // of u, per point
};

template <int Dim>
ElementShare<Dim> share_of(const QuadratureElement<Dim>& element, const SplineBasis<Dim>& probes,
                           const ControlPoints<Dim>& phi, const WeightField<Dim>& rigid) {
  ElementShare<Dim> share;
  const Eigen::Index count = element.weights.size();
  share.weights = element.weights;
  const ControlPoints<Dim> own = phi(Eigen::all, element.control_points);
  for (Eigen::Index q = 0; q < count; ++q) {
    const Point<Dim> x = element.points.col(q);
    const double w = rigid ? rigid(x, element.region) : 0.0;
    share.weights[q] *= element.in_band ? 0.0 : (1 - w) * (1 - w);
    share.probes.push_back(probes.evaluate(probes.contains(x) ? x : probes.nearest_point(x), 2));
    Eigen::Matrix<double, Dim, kNumSecondDerivatives<Dim>> u;
    for (int s = 0; s < kNumSecondDerivatives<Dim>; ++s) {
      u.col(s) = own * element.hessians[s].col(q);
    }
    share.bending.push_back(u);
  }
  return share;
}

template <int Dim>
ProbedBending<Dim> probe_bending(const MinimumReached<Dim>& minimum,
                                 const SplineBasis<Dim>& probes) {
  const int n = probes.num_control_points();
  const auto twice = multiplicities<Dim>();
  ProbedBending<Dim> result{ControlPoints<Dim>::Zero(Dim, n), Eigen::VectorXd::Zero(n),
                            Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  const SplineBasis<Dim>& basis = minimum.transform.basis();
  visit_quadrature<Dim>(basis, basis.product_degree(2, 2), 2, nullptr, [&](auto& elements) {
    std::vector<ElementShare<Dim>> shares(elements.size());
    parallel_for(std::ssize(elements), [&](std::int64_t e) {
      shares[e] = share_of(elements[e], probes, minimum.transform.control_points(), minimum.rigid);
    });
    for (std::size_t e = 0; e < elements.size(); ++e) {
      for (std::size_t q = 0; q < shares[e].probes.size(); ++q) {
        const BasisValues<Dim>& probe = shares[e].probes[q];
        const double soft = shares[e].weights[static_cast<Eigen::Index>(q)];
        const double all = elements[e].weights[static_cast<Eigen::Index>(q)];
        for (std::size_t k = 0; k < probe.control_points.size(); ++k) {
          const int i = probe.control_points[k];
          const auto b = probe.hessians.col(static_cast<Eigen::Index>(k));
          const Eigen::Matrix<double, kNumSecondDerivatives<Dim>, 1> weighted =
              soft * twice.cwiseProduct(b);
          result.force.col(i) += shares[e].bending[q] * weighted;
          result.stiffness[i] += weighted.dot(b);
          result.soft[i] += soft * probe.values[static_cast<Eigen::Index>(k)];
          result.mass[i] += all * probe.values[static_cast<Eigen::Index>(k)];
        }
      }
    }
  });
  return result;
}

/// Mean distance of control points, in units of the edges: a third for cubics on triangles, 1 for tensor
/// products.
template <int Dim>
double relative_spacing(const SplineBasis<Dim>& basis) {
  return std::pow(basis.measure() / basis.num_control_points(), 1.0 / Dim) /
         basis.mean_edge_length();
}

/// Smallest and largest edge of the patches.
template <int Dim>
std::pair<double, double> edge_range(const SplineBasis<Dim>& basis) {
  double smallest = std::numeric_limits<double>::infinity(), largest = 0;
  const ControlPoints<Dim> greville = basis.greville_points();
  for (Eigen::Index i = 0; i < greville.cols(); ++i) {
    const double edge = basis.edge_length(basis.nearest_point(greville.col(i)));
    smallest = std::min(smallest, edge);
    largest = std::max(largest, edge);
  }
  return {smallest, largest};
}

/// The significant places among the probes of one size: where it is about half the distance of control points.
template <int Dim>
void add_places_of_size(const MinimumReached<Dim>& minimum, double size,
                        std::vector<FinerPlace<Dim>>& places) {
  const Raster<Dim>& raster = minimum.grid->raster();
  const TensorBSplineBasis<Dim> probes(covering_lattice(raster, size));
  const int n = probes.num_control_points();
  ImageTerm<Dim> image(std::make_shared<ProbeGrid<Dim>>(minimum.grid, probes.bind(raster)),
                       minimum.metric, minimum.transform.affine());
  ControlPoints<Dim> force = ControlPoints<Dim>::Zero(Dim, n);
  BlockHessian<Dim> curvature(probes.pattern());
  image.evaluate(minimum.transform.control_points(), minimum.image_weight, &force, &curvature);
  const ProbedBending<Dim> bending = probe_bending(minimum, probes);
  force += minimum.bending_weight * bending.force;
  const SplineBasis<Dim>& basis = minimum.transform.basis();
  const ControlPoints<Dim> centres = probes.greville_points();
  const double spacing = relative_spacing(basis);
  for (int i = 0; i < n; ++i) {
    const Point<Dim> centre = centres.col(i);
    if (!basis.contains(centre) || !(bending.soft[i] > kLeastSoftShare * bending.mass[i])) continue;
    const double edge = basis.edge_length(centre);
    const double halved = spacing * edge / 2;
    if (halved < size / std::sqrt(2.0) || halved >= size * std::sqrt(2.0)) continue;
    Matrix<Dim> H = curvature.block(probes.pattern()->slot(i, i));
    H = H.template selfadjointView<Eigen::Lower>();
    H.diagonal().array() += minimum.bending_weight * bending.stiffness[i];
    const double trace = H.trace();
    if (!(trace > 0)) continue;
    H.diagonal().array() += 1e-9 * trace;
    const Vector<Dim> g = force.col(i);
    const double gain = 0.5 * g.dot(H.inverse() * g);
    if (gain > kSignificant * minimum.noise_density) {
      places.push_back({centre, 2 * size, edge / 2, gain});
    }
  }
}

}  // namespace

template <int Dim>
std::vector<FinerPlace<Dim>> finer_places(const MinimumReached<Dim>& minimum) {
  const auto [smallest, largest] = edge_range(minimum.transform.basis());
  const double least = kLeastPixels * minimum.grid->raster().spacing.minCoeff();
  std::vector<FinerPlace<Dim>> places;
  const double spacing = relative_spacing(minimum.transform.basis());
  double size = spacing * largest / 2;
  while (size >= least && size * std::sqrt(2.0) > spacing * smallest / 2) {
    add_places_of_size(minimum, size, places);
    size /= 2;
  }
  std::ranges::stable_sort(places, std::ranges::greater(), &FinerPlace<Dim>::gain);
  const double all = std::accumulate(places.begin(), places.end(), 0.0,
                                     [](double sum, const auto& p) { return sum + p.gain; });
  double sum = 0;
  std::size_t kept = 0;
  while (kept < places.size() && sum < kShareOfGain * all) sum += places[kept++].gain;
  places.resize(kept);
  return places;
}

template std::vector<FinerPlace<2>> finer_places<2>(const MinimumReached<2>&);
template std::vector<FinerPlace<3>> finer_places<3>(const MinimumReached<3>&);

}  // namespace crease

#include "Testing/Experiments/BreastSpaces.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <set>

#include "Core/Parallel.h"
#include "Registration/Elastic/BorderConstraints.h"
#include "Registration/Elastic/LoadSteps.h"
#include "Registration/Phantoms/MammogramBody.h"
#include "Registration/Phantoms/MammogramOutline.h"
#include "Transforms/SplineProjection.h"

namespace crease::experiments {
namespace {

constexpr double kBand = 5;  // mm on both sides of the muscle's edge

DisplacementFunction<2> displacement_of(const MammogramDeformation& truth) {
  return [&truth](const Point<2>& x) -> Vector<2> { return truth(x) - x; };
}

SplineTransform<2> transform_with(const BreastBasis& basis, const ControlPoints<2>& phi) {
  SplineTransform<2> map(basis);
  map.set_control_points(phi);
  return map;
}

struct ErrorSums {
  double all = 0, band = 0, gradient_band = 0, largest = 0;
  int num_all = 0, num_band = 0;

  ErrorSums& operator+=(const ErrorSums& other) {
    all += other.all, band += other.band, gradient_band += other.gradient_band;
    num_all += other.num_all, num_band += other.num_band;
    largest = std::max(largest, other.largest);
    return *this;
  }
};

}  // namespace

BreastBasis basis_on(const DomainMesh& mesh, Space space, BorderRule border) {
  KnotOptions options;
  options.degree = 2;
  options.creases = space == kCreases;
  options.border = border;
  options.collapse_all = space == kLagrange;
  return std::make_shared<const TriangularBSplineBasis<2>>(place_knots(mesh, options).net);
}

ElasticMaterial breast_material() {
  ElasticMaterial material;
  material.law = ElasticLaw::kNeoHookean;
  material.regions[kPectoralRegion] = {.young = MammogramBodyOptions().muscle_stiffness};
  return material;
}

MapError error_of(const SplineTransform<2>& map, const MammogramDeformation& truth) {
  const int size = static_cast<int>(kMammogramWidthMm);
  const auto add_row = [&](std::int64_t row, ErrorSums& sums) {
    for (int i = 0; i < size; ++i) {
      const Point<2> x(i + 0.5, static_cast<double>(row) + 0.5), p = x / kMammogramWidthMm;
      if (!(skin_depth(p) > 0) || !map.in_domain(x)) continue;
      const auto here = map.sample(x);
      const double error = (here.point - truth(x)).squaredNorm();
      sums.all += error;
      sums.largest = std::max(sums.largest, std::sqrt(error));
      ++sums.num_all;
      if (std::abs(pectoral_depth(p)) * kMammogramWidthMm > kBand) continue;
      sums.band += error;
      sums.gradient_band += (here.jacobian - truth.jacobian(x)).squaredNorm();
      ++sums.num_band;
    }
  };
  const ErrorSums sums = parallel_sum(size, ErrorSums{}, add_row, 1);
  return {.rms = std::sqrt(sums.all / sums.num_all),
          .band = std::sqrt(sums.band / sums.num_band),
          .max = sums.largest,
          .gradient_band = std::sqrt(sums.gradient_band / sums.num_band)};
}

Json to_json(const MapError& error) {
  return {{"tre_rms_mm", error.rms},
          {"tre_band_mm", error.band},
          {"tre_max_mm", error.max},
          {"gradient_band", error.gradient_band}};
}

SplineTransform<2> nearest_spline(const BreastBasis& basis, const MammogramDeformation& truth) {
  return transform_with(basis, project<2>(*basis, displacement_of(truth)).control_points);
}

HeldBreast::HeldBreast(const DomainMesh& mesh, Space space)
    : basis_(basis_on(mesh, space, BorderRule::kCollapsed)), energy_(*basis_, breast_material()) {}

SplineTransform<2> HeldBreast::settle(const MammogramDeformation& truth) const {
  const auto border =
      border_constraints(*basis_, interpolate_on_edges(*basis_, displacement_of(truth)));
  const LoadStepResult result =
      run_load_steps(energy_, *basis_, border, {.schedule = LoadSchedule::kAdaptive});
  return transform_with(basis_, result.control_points);
}

EffectiveUnknowns effective_unknowns(const BreastBasis& basis) {
  constexpr int kSteps = 400;
  std::set<int> active;
  for (const Point<2>& p : pectoral_line(0, kSteps)) {
    const Point<2> x = kMammogramWidthMm * p;
    if (!basis->contains(x)) continue;
    const auto here = basis->evaluate(x);
    for (std::size_t n = 0; n < here.control_points.size(); ++n) {
      if (here.values[static_cast<Eigen::Index>(n)] > 1e-9) active.insert(here.control_points[n]);
    }
  }
  const auto zero = [](const Point<2>&) -> Vector<2> { return Vector<2>::Zero(); };
  Eigen::MatrixXd mass = projection_system<2>(*basis, zero).mass;
  const Eigen::VectorXd scale = mass.diagonal().cwiseSqrt().cwiseInverse();
  mass = scale.asDiagonal() * mass * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(mass, Eigen::EigenvaluesOnly);
  return {.control_points = basis->num_control_points(),
          .on_the_line = static_cast<int>(active.size()),
          .least_eigenvalue = eigen.eigenvalues()[0]};
}

}  // namespace crease::experiments

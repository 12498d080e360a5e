#include "Applications/RegisterBasis.h"

#include <algorithm>

#include "Transforms/Splines/NurbsBasis.h"
#include "Transforms/Splines/TSplineRefinement.h"
#include "Transforms/Splines/ThinPlateBasis.h"

namespace crease {
namespace {

RegisterBasis<2> basis_on_triangles(const RegisterOptions& options, const RegisterInput<2>& input,
                                    RunReport& report, const std::vector<FinerPlace<2>>& finer) {
  CreasedDomainOptions wanted = {.spline = options.is_triangular() ? TriangleSpline::kTriangular
                                                                   : TriangleSpline::kPowellSabin,
                                 .degree = options.spline_degree(),
                                 .smoothness = options.spline_smoothness(),
                                 .creases = !options.no_creases,
                                 .edge_length = options.mesh_size.value_or(0),
                                 .num_triangles = options.triangles.value_or(0),
                                 .rigid_bodies = options.rigidity_weight() > 0};
  if (options.landmarks_conflict == "refine" && options.landmarks_mode == "exact") {
    wanted.landmarks = input.landmarks;
  }
  for (const FinerPlace<2>& place : finer) {
    wanted.fine_discs.push_back({place.centre, place.radius, place.edge_length});
  }
  const RegionOfInterest region =
      input.region ? *input.region : rectangle_of(input.fixed.image.raster());
  CreasedDomain domain =
      input.labels ? make_creased_domain(region, *input.labels, input.feature_lines, wanted)
                   : make_creased_domain(region, input.feature_lines, wanted);
  if (finer.empty()) report.add_warnings(domain.warnings);
  RegisterBasis<2> result{
      .basis = domain.basis, .domain = {}, .bodies = nullptr, .region_at = nullptr};
  if (domain.has_bodies()) result.bodies = body_weights<2>();
  result.domain = std::move(domain);
  return result;
}

/// A T-spline, finer in some places.
std::shared_ptr<const SplineBasis<2>> tspline_basis(const Raster<2>& raster, double length,
                                                    int degree,
                                                    const std::vector<FinerPlace<2>>& finer) {
  if (finer.empty()) return covering_tspline(raster, length, nullptr, degree);
  const EdgeLengthField wanted = [&](const Point<2>& x) {
    double edge = length;
    for (const FinerPlace<2>& place : finer) {
      if ((x - place.centre).norm() <= place.radius) edge = std::min(edge, place.edge_length);
    }
    return edge;
  };
  return covering_tspline(raster, length, wanted, degree);
}

template <int Dim>
std::shared_ptr<const SplineBasis<Dim>> covering_basis(const RegisterOptions& options,
                                                       const Raster<Dim>& raster,
                                                       const Landmarks<Dim>& landmarks,
                                                       const std::vector<FinerPlace<Dim>>& finer) {
  const double length = options.mesh_size.value_or(default_edge_length<Dim>(raster.bounds()));
  const int degree = options.spline_degree();
  if (options.transform == "nurbs") {
    return std::make_shared<const NurbsBasis<Dim>>(covering_nurbs(raster, length, degree));
  }
  if (options.transform == "thin-plate") {
    return covering_thin_plate<Dim>(raster, length, landmarks.fixed);
  }
  if constexpr (Dim == 2) {
    if (options.transform == "tspline") return tspline_basis(raster, length, degree, finer);
  }
  return std::make_shared<const TensorBSplineBasis<Dim>>(covering_lattice(raster, length), degree);
}

}  // namespace

template <int Dim>
RegisterBasis<Dim> make_register_basis(const RegisterOptions& options,
                                       const RegisterInput<Dim>& input, RunReport& report,
                                       const std::vector<FinerPlace<Dim>>& finer) {
  if constexpr (Dim == 2) {
    if (options.has_triangles()) return basis_on_triangles(options, input, report, finer);
  }
  RegisterBasis<Dim> result;
  result.basis = covering_basis(options, input.fixed.image.raster(), input.landmarks, finer);
  if (input.labels) {
    result.bodies = label_weights(*input.labels);
    result.region_at = region_of_label(*input.labels);
  }
  return result;
}

template RegisterBasis<2> make_register_basis<2>(const RegisterOptions&, const RegisterInput<2>&,
                                                 RunReport&, const std::vector<FinerPlace<2>>&);
template RegisterBasis<3> make_register_basis<3>(const RegisterOptions&, const RegisterInput<3>&,
                                                 RunReport&, const std::vector<FinerPlace<3>>&);

}  // namespace crease

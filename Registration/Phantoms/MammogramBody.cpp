#include "Registration/Phantoms/MammogramBody.h"

#include <numbers>

#include "Registration/Elastic/BorderConstraints.h"
#include "Registration/Elastic/LoadSteps.h"
#include "Registration/Phantoms/MammogramOutline.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/Mesher.h"

namespace crease {
namespace {

std::shared_ptr<const TriangularBSplineBasis<2>> lagrange_basis(const DomainMesh& domain) {
  const KnotOptions options{.degree = 2, .collapse_all = true};
  return std::make_shared<const TriangularBSplineBasis<2>>(place_knots(domain, options).net);
}

}  // namespace

DomainMesh mesh_of_mammogram(int num_triangles, bool muscle) {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  constexpr int kSkinPoints = 4000;
  const double tolerance = 0.3 * 600 / num_triangles;  // falls with the square of the edge length
  Polyline ring = skin_line(-kQuarter, kQuarter, kSkinPoints);
  for (Point<2>& p : ring) p *= kMammogramWidthMm;
  std::vector<FeatureLine> lines(muscle ? 1 : 0);
  for (FeatureLine& line : lines) {
    line.points = pectoral_line(0, 2);  // straight
    for (Point<2>& p : line.points) p *= kMammogramWidthMm;
  }
  MeshOptions options;
  options.num_triangles = num_triangles;
  DomainMesh domain =
      mesh_domain(RegionOfInterest({simplify_polyline(ring, true, tolerance)}), lines, options);
  SimplexMesh<2>& mesh = domain.mesh;
  mesh.regions.assign(mesh.simplices.size(), 0);
  for (std::size_t t = 0; muscle && t < mesh.simplices.size(); ++t) {
    const auto& s = mesh.simplices[t];
    const Point<2> centre = (mesh.vertices[s[0]] + mesh.vertices[s[1]] + mesh.vertices[s[2]]) / 3;
    if (pectoral_depth(centre / kMammogramWidthMm) > 0) mesh.regions[t] = kPectoralRegion;
  }
  return domain;
}

MammogramBody::MammogramBody(const MammogramBodyOptions& options)
    : basis_(lagrange_basis(mesh_of_mammogram(options.num_triangles, options.muscle))),
      muscle_stiffness_(options.muscle ? options.muscle_stiffness : 1) {}

MammogramBody::Equilibrium MammogramBody::follow(const MammogramMotion& motion) const {
  const MammogramDeformation border(motion);
  const ControlPoints<2> moved =
      interpolate_on_edges(*basis_, [&](const Point<2>& x) -> Vector<2> { return border(x) - x; });
  ElasticMaterial material;
  material.law = ElasticLaw::kNeoHookean;
  if (muscle_stiffness_ != 1) material.regions[kPectoralRegion] = {.young = muscle_stiffness_};
  const ElasticEnergy<2> energy(*basis_, material);
  const LoadStepResult result = run_load_steps(energy, *basis_, border_constraints(*basis_, moved),
                                               {.schedule = LoadSchedule::kAdaptive});
  const auto further = std::make_shared<SplineTransform<2>>(basis_);
  further->set_control_points(result.control_points - moved);
  return {further, result.least_determinant.value};
}

}  // namespace crease

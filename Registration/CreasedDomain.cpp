#include "Registration/CreasedDomain.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Registration/LandmarkRefinement.h"
#include "Transforms/Domains/LabelOutlines.h"
#include "Transforms/Domains/Mesher.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/PowellSabinCreases.h"

namespace crease {
namespace {

double edge_length_near_lines(const RegionOfInterest& region, const CreasedDomainOptions& options) {
  if (options.edge_length_near_lines > 0) return options.edge_length_near_lines;
  const double elsewhere =
      options.edge_length > 0 ? options.edge_length : default_edge_length(region.bounds());
  return elsewhere / 2;
}

void append(std::vector<std::string>& texts, const std::vector<std::string>& more) {
  texts.insert(texts.end(), more.begin(), more.end());
}

void add_triangular_basis(const CreasedDomainOptions& options, CreasedDomain& domain) {
  PlacedKnots knots =
      place_knots(domain.mesh, {.degree = options.degree,
                                .smoothness = options.smoothness,
                                .creases = options.creases,
                                .collapse_inside_bodies = options.creases && options.rigid_bodies,
                                .collapse_all = options.collapse_knots});
  domain.plan = std::move(knots.plan);
  domain.basis = std::make_shared<const TriangularBSplineBasis<2>>(std::move(knots.net));
}

CreasedDomain domain_with_discs(const RegionOfInterest& region,
                                const std::vector<FeatureLine>& lines,
                                const CreasedDomainOptions& options,
                                const std::vector<FineDisc>& discs) {
  CreasedDomain domain;
  domain.feature_lines = lines;
  domain.mesh = mesh_domain(region, lines,
                            {.edge_length = options.edge_length,
                             .edge_length_near_lines = options.edge_length_near_lines,
                             .gradation = options.gradation,
                             .fine_discs = discs,
                             .num_triangles = options.num_triangles,
                             .line_tolerance = options.line_tolerance});
  if (options.spline == TriangleSpline::kPowellSabin) {
    domain.basis = std::make_shared<const PowellSabinBasis>(
        place_powell_sabin(domain.mesh, {.creases = options.creases}));
  } else {
    add_triangular_basis(options, domain);
  }
  domain.notes = domain.mesh.notes;
  domain.warnings = domain.mesh.warnings;
  append(domain.warnings, domain.plan.warnings);
  return domain;
}

}  // namespace

bool CreasedDomain::has_bodies() const {
  return std::ranges::any_of(mesh.mesh.regions, [](int region) { return region > 0; });
}

const TriangularBSplineBasis<2>& CreasedDomain::triangular_basis() const {
  const auto* triangular = dynamic_cast<const TriangularBSplineBasis<2>*>(basis.get());
  if (triangular == nullptr) {
    throw InvalidInput("CreasedDomain: its splines are no triangular B-splines.");
  }
  return *triangular;
}

CreasedDomain make_creased_domain(const RegionOfInterest& region,
                                  const std::vector<FeatureLine>& lines,
                                  const CreasedDomainOptions& options) {
  const DomainMaker make = [&](std::vector<FineDisc> discs) {
    discs.insert(discs.end(), options.fine_discs.begin(), options.fine_discs.end());
    return domain_with_discs(region, lines, options, discs);
  };
  return options.landmarks.empty() ? make({}) : refined_for_landmarks(options.landmarks, make);
}

CreasedDomain make_creased_domain(const RegionOfInterest& region, const LabelImage<2>& labels,
                                  const std::vector<FeatureLine>& lines,
                                  const CreasedDomainOptions& options) {
  CreasedDomainOptions chosen = options;
  if (!(chosen.line_tolerance > 0)) chosen.line_tolerance = labels.raster().spacing.maxCoeff();
  const LabelOutlines outlines = label_outlines(
      labels.raster(), labels.values(),
      {.edge_length = edge_length_near_lines(region, chosen), .tolerance = chosen.line_tolerance});
  std::vector<FeatureLine> all = outlines.lines;
  all.insert(all.end(), lines.begin(), lines.end());
  CreasedDomain domain = make_creased_domain(region, all, chosen);
  domain.warnings.insert(domain.warnings.begin(), outlines.warnings.begin(),
                         outlines.warnings.end());
  return domain;
}

LabelImage<2> body_labels(const CreasedDomain& domain, const Raster<2>& raster) {
  LabelImage<2> labels(raster);
  const Vector<2> step = raster.index_to_point().col(0);
  const KnotLocator<2> locator(domain.mesh.mesh, kKnotTie * mesh_scale(domain.mesh.mesh));
  parallel_for(raster.num_rows(), [&](std::int64_t r) {
    const auto row = labels.row(r);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const int simplex = locator.find(raster.row_start(r) + static_cast<double>(i) * step);
      if (simplex >= 0) row[i] = domain.mesh.mesh.region(simplex);
    }
  });
  return labels;
}

namespace {

/// The label at a point, of the nearest sample; 0 outside the image.
template <int Dim>
int label_at(const LabelImage<Dim>& labels, const Point<Dim>& x) {
  const Raster<Dim>& raster = labels.raster();
  const Vector<Dim> position = raster.index(x);
  typename LabelImage<Dim>::Index index;
  for (int a = 0; a < Dim; ++a) {
    const double nearest = std::round(position[a]);
    if (!(nearest >= 0 && nearest < raster.size[a])) return 0;
    index[a] = static_cast<int>(nearest);
  }
  return static_cast<int>(labels[index]);
}

}  // namespace

template <int Dim>
std::function<int(const Point<Dim>&)> region_of_label(const LabelImage<Dim>& labels) {
  const auto image = std::make_shared<const LabelImage<Dim>>(labels);
  return [image](const Point<Dim>& x) { return label_at<Dim>(*image, x); };
}

template <int Dim>
WeightField<Dim> label_weights(const LabelImage<Dim>& labels) {
  const auto image = std::make_shared<const LabelImage<Dim>>(labels);
  return [image](const Point<Dim>& x, int) { return label_at<Dim>(*image, x) > 0 ? 1.0 : 0.0; };
}

template std::function<int(const Point<2>&)> region_of_label<2>(const LabelImage<2>&);
template std::function<int(const Point<3>&)> region_of_label<3>(const LabelImage<3>&);
template WeightField<2> label_weights<2>(const LabelImage<2>&);
template WeightField<3> label_weights<3>(const LabelImage<3>&);

}  // namespace crease

#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Elastic/ImageRefinement.h"
#include "Registration/Elastic/LoadSteps.h"

namespace crease {

/// An elastic body in the fixed image: its outline, and what it is made of.
struct ElasticBody {
  RegionOfInterest region;
  /// Creases; closed ones may give their inside a label, as that of a muscle (outline_beyond).
  std::vector<FeatureLine> lines = {};
  /// Labels k > 0 are tissues of their own, their outlines creases; null: none.
  const LabelImage<2>* labels = nullptr;
  ElasticMaterial material = {};
};

/// Its mesh and splines.
struct ElasticDomainOptions {
  int degree = 2;
  bool creases = true;
  int num_triangles = 600;  ///< 0: by the edge length
  double edge_length = 0;   ///< mm; 0: a twelfth of the longer side
  /// mm that the mesh's border may run off the region's outline, and creases off lines; three times as much
  /// where edges would be short.
  double outline_tolerance = 0.3;
};

/// Meshes a body so that its lines and the outlines of its tissues are creases. Its border is made of few
/// straight pieces, for every vertex on it is one of the mesh.
/// @throws InvalidInput as make_creased_domain().
CreasedDomain make_elastic_domain(const ElasticBody& body,
                                  const ElasticDomainOptions& options = {});

/// How a moving image is carried onto a fixed one by deforming an elastic body.
struct ElasticRegistrationOptions {
  LoadStepOptions load;
  ElasticQuadrature quadrature = ElasticQuadrature::kCells;  ///< of the load steps
  bool refine = true;
  /// Its material, pins and grid are set by the registration.
  ImageRefinementOptions refinement;
  bool pin_contour =
      false;  ///< hold all pairs on the contour in the refinement, besides the chest wall's ends
};

/// What was found, and how.
struct ElasticRegistrationResult {
  LoadStepResult load;
  std::shared_ptr<const SplineTransform<2>> deformation;  ///< y -> y + u*(y)
  std::optional<ImageRefinementResult> refinement;
  /// x -> y + u*(y), y = x + v(x): a CompositeTransform, the deformation alone without refinement.
  std::shared_ptr<const Transform<2>> transform;
  bool images_equal = false;  ///< before; improvements are undefined then
  /// Per cent of |T - R|^2 (ImageImprovement), after the pairs and after the refinement.
  std::optional<double> improvement_by_pairs, improvement_by_images;
  /// Empty: in equilibrium under the whole load, and refined if that was wanted. Else what happened, and what the
  /// result is instead: the last equilibrium, not refined.
  std::string failure;
  int factorizations = 0;
  std::map<std::string, double>
      timings_s;  ///< "load steps", "binding", "refinement", "improvement"
  std::vector<std::string> warnings;
};

/// The elastic registration of a temporal pair of mammograms (TBFEM): first the nonlinear elastic equilibrium of
/// the fixed image's body when point pairs carry it onto the moving image, then a refinement by intensities.
///
/// @param pairs    fixed points in the body; met exactly by the first step.
/// @param contour  numbers of the pairs on the body's outline, in order along it; empty: found by their places.
/// @param mask     of the fixed image: samples that count; null: all in the body.
/// @throws InvalidInput as deform_elastically() and refine_by_images(). Without an equilibrium the result says so.
/// Source: dissertation, chapter 4.
ElasticRegistrationResult register_elastically(const Image<float, 2>& fixed,
                                               const Image<float, 2>& moving, const Mask<2>* mask,
                                               const ElasticBody& body, const CreasedDomain& domain,
                                               const Landmarks<2>& pairs,
                                               const std::vector<int>& contour,
                                               const ElasticRegistrationOptions& options = {},
                                               const RegistrationCallback& progress = {});

}  // namespace crease

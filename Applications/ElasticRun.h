#pragma once

#include "Applications/ElasticInput.h"
#include "Applications/ProgressReporter.h"

namespace crease {

/// What an elastic registration found.
struct ElasticOutcome {
  CreasedDomain domain;
  ElasticMaterial material;
  Landmarks<2> pairs;  ///< as they were met
  ElasticRegistrationResult registration;
  /// From the fixed image to the moving one as given: registration.transform, and a reflection behind it where
  /// the moving image was mirrored.
  std::shared_ptr<const Transform<2>> transform;
};

/// Meshes the body and registers. Warnings and timings go to the report.
ElasticOutcome run_elastic(const ElasticCommandOptions& options, const ElasticInput& input,
                           RunReport& report, ProgressReporter& progress);

}  // namespace crease

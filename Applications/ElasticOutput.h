#pragma once

#include <functional>
#include <vector>

#include "Applications/ElasticRun.h"
#include "Applications/OutputFolder.h"
#include "Applications/TransformImages.h"
#include "Registration/Evaluation.h"

namespace crease {

/// Images that follow from the transform, on the fixed grid.
struct ElasticImages : TransformImages<2> {
  Image<float, 2> warped;     ///< the moving image at T(x); NaN outside it
  Image<float, 2> before;     ///< the moving image at x, mirrored where it was; the same
  Image<float, 2> stiffness;  ///< Young's modulus; NaN outside the body
};

/// The creases of a mesh as lines, to be drawn.
std::vector<FeatureLine> crease_lines(const CreasedDomain& domain);

ElasticImages make_images(const ElasticInput& input, const ElasticOutcome& outcome);

/// Determinants and folds over the body.
Evaluation<2> evaluate_outcome(const ElasticImages& images);

/// Target errors over the body where the truth is known: without a map (but mirrored), after the pairs, after
/// the refinement.
struct TargetErrors {
  ErrorStatistics before, by_pairs;
  std::optional<ErrorStatistics> by_images;
};
std::optional<TargetErrors> target_errors(const ElasticInput& input, const ElasticOutcome& outcome);

/// displacement.mha, into the moving image as it is given.
void write_displacement(const OutputFolder& output, const ElasticInput& input,
                        DisplacementField<2> displacement);

/// warped.*, jacobian.mha, transform.json and pairs.csv.
void write_results(const OutputFolder& output, const ElasticCommandOptions& options,
                   const ElasticInput& input, const ElasticOutcome& outcome,
                   const ElasticImages& images);

/// pictures/*.png for people, and further jobs at the same time, in parallel.
void write_pictures(const OutputFolder& output, const ElasticInput& input,
                    const ElasticOutcome& outcome, const ElasticImages& images,
                    std::vector<std::function<void()>> further_jobs = {});

}  // namespace crease

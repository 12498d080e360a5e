#pragma once

#include <functional>
#include <vector>

#include "Applications/OutputFolder.h"
#include "Applications/RegisterInput.h"
#include "Applications/RegisterRun.h"
#include "Applications/TransformImages.h"
#include "Registration/Evaluation.h"

namespace crease {

/// Images that follow from the transform, on the fixed grid.
template <int Dim>
struct RegisterImages : TransformImages<Dim> {
  Image<float, Dim> warped;                       ///< moving(T(x)); NaN outside the moving image
  Image<float, Dim> before;                       ///< moving(x), the same
  std::vector<Image<float, Dim>> further_warped;  ///< of further channels
};

template <int Dim>
RegisterImages<Dim> make_images(const RegisterOptions& options, const RegisterInput<Dim>& input,
                                const Transform<Dim>& transform);

/// Folds, bodies and match of the images, over the domain.
template <int Dim>
Evaluation<Dim> evaluate_outcome(const RegisterOptions& options, const RegisterInput<Dim>& input,
                                 const RegisterOutcome<Dim>& outcome,
                                 const RegisterImages<Dim>& images);

/// warped.* (warped-2.* and so on of further channels), displacement.mha, jacobian.mha, transform.json and, where ITK has the same, transform.tfm.
template <int Dim>
void write_results(const OutputFolder& output, const RegisterOptions& options,
                   const RegisterInput<Dim>& input, const RegisterOutcome<Dim>& outcome,
                   const RegisterImages<Dim>& images);

/// pictures/*.png for people, and further jobs at the same time, in parallel.
template <int Dim>
void write_pictures(const OutputFolder& output, const RegisterOptions& options,
                    const RegisterInput<Dim>& input, const RegisterOutcome<Dim>& outcome,
                    const RegisterImages<Dim>& images,
                    std::vector<std::function<void()>> further_jobs = {});

}  // namespace crease

#pragma once

#include <optional>
#include <vector>

#include "Applications/InputFiles.h"
#include "Applications/RegisterOptions.h"
#include "Transforms/AffineMap.h"
#include "Transforms/Domains/FeatureLine.h"
#include "Transforms/Domains/RegionOfInterest.h"

namespace crease {

/// All files of `crease register`, read and checked. Masks are on the grids of their images, labels on the
/// fixed grid.
template <int Dim>
struct RegisterInput {
  ReadImage<Dim> fixed, moving;
  std::vector<ReadImage<Dim>> further_fixed, further_moving;  ///< of further channels
  std::optional<Mask<Dim>> fixed_mask, moving_mask;           ///< of all channels
  std::optional<LabelImage<Dim>> labels;
  Landmarks<Dim> landmarks;
  std::optional<RegionOfInterest> region;  ///< 2D
  std::vector<FeatureLine> feature_lines;  ///< 2D
  std::optional<AffineMap<Dim>> start;     ///< of --init FILE
};

/// 2 or 3. @throws InvalidInput when fixed and moving image differ; UsageError when the transform chosen
/// does not exist in that dimension.
int dimension_of(const RegisterOptions& options);

/// @throws FileError, InvalidInput naming the file; UsageError naming the option.
template <int Dim>
RegisterInput<Dim> read_input(const RegisterOptions& options, RunReport& report);

}  // namespace crease

#include "Applications/RegisterInput.h"

#include <algorithm>

#include "Applications/ExitCode.h"
#include "Applications/RegionInput.h"
#include "Applications/TransformInput.h"
#include "Images/RasterCheck.h"
#include "Transforms/AffineEquivalent.h"
#include "Transforms/Domains/FeatureLineFile.h"

namespace crease {
namespace {

/// The affine map of --init FILE.
template <int Dim>
AffineMap<Dim> read_start(const std::string& file, RunReport& report) {
  if (const int dimension = transform_dimension({file}); dimension != Dim) {
    throw InvalidInput(
        message("--init ", file, " is ", dimension, "D, but the images are ", Dim, "D."));
  }
  if (const auto map = affine_equivalent(*read_transforms<Dim>(report, {file}))) return *map;
  throw InvalidInput(message(
      "--init ", file,
      ": only a rigid or affine transform, a similarity, a shift or a chain of these can be the "
      "start, and this one bends space; warp the moving image with it first."));
}

template <int Dim>
LabelImage<Dim> read_bodies(const RegisterOptions& options, const Raster<Dim>& fixed,
                            InputFiles& input) {
  const std::string& file = *options.rigid_labels;
  LabelImage<Dim> labels = on_raster(input.labels<Dim>("rigid-labels", file), fixed);
  if (std::ranges::none_of(labels.values(), [](std::int32_t label) { return label > 0; })) {
    throw InvalidInput(
        message("--rigid-labels ", file,
                ": no label above 0 lies in the fixed image; label rigid bodies 1, 2, "
                "... in its space."));
  }
  return labels;
}

}  // namespace

int dimension_of(const RegisterOptions& options) {
  std::vector<std::string> files;
  for (std::size_t c = 0; c < options.num_channels(); ++c) {
    files.insert(files.end(), {options.fixed[c], options.moving[c]});
  }
  const int dimension = InputFiles::common_dimension(files);
  if (dimension == 3 && options.is_plane_only()) {
    throw UsageError(message("--transform triangular-bspline works on 2D images, and ",
                             options.fixed.front(),
                             " is 3D; take bspline, affine or rigid for volumes."));
  }
  return dimension;
}

template <int Dim>
RegisterInput<Dim> read_input(const RegisterOptions& options, RunReport& report) {
  InputFiles input(report, options.spacing);
  RegisterInput<Dim> read;
  read.fixed = input.image<Dim>("fixed", options.fixed.front());
  read.moving = input.image<Dim>("moving", options.moving.front());
  const Raster<Dim>& fixed = read.fixed.image.raster();
  for (std::size_t c = 1; c < options.num_channels(); ++c) {
    read.further_fixed.push_back(input.image<Dim>("fixed", options.fixed[c]));
    read.further_moving.push_back(input.image<Dim>("moving", options.moving[c]));
    const Raster<Dim>& own = read.further_fixed.back().image.raster();
    if (same_raster(own, fixed)) continue;
    throw InvalidInput(message("the fixed images have different grids: ", options.fixed.front(),
                               " has ", describe(fixed), ", ", options.fixed[c], " has ",
                               describe(own), "; resample one onto the other's grid."));
  }
  if (options.fixed_mask) {
    read.fixed_mask = on_raster(input.mask<Dim>("fixed-mask", *options.fixed_mask), fixed);
  }
  if (options.moving_mask) {
    read.moving_mask =
        on_raster(input.mask<Dim>("moving-mask", *options.moving_mask), read.moving.image.raster());
  }
  if (options.rigid_labels) read.labels = read_bodies<Dim>(options, fixed, input);
  if (!options.landmarks.empty())
    read.landmarks = input.landmarks<Dim>("landmarks", options.landmarks);
  if constexpr (Dim == 2) {
    if (options.roi) read.region = read_region(*options.roi, fixed, input, report);
    if (options.feature_lines) {
      read.feature_lines = read_feature_lines(*options.feature_lines);
      report.add_input("feature-lines", *options.feature_lines);
    }
  }
  if (options.init_is_file()) read.start = read_start<Dim>(*options.init, report);
  input.check_spacing_was_used();
  return read;
}

template RegisterInput<2> read_input<2>(const RegisterOptions&, RunReport&);
template RegisterInput<3> read_input<3>(const RegisterOptions&, RunReport&);

}  // namespace crease

#include "Applications/RegisterOutput.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Applications/ImageOutput.h"
#include "Core/Parallel.h"
#include "Images/MakeInterpolator.h"
#include "Images/Resample.h"
#include "Registration/Pictures.h"
#include "Transforms/TransformFile.h"
#include "Transforms/TransformFileItk.h"

namespace crease {
namespace {

using Path = std::filesystem::path;

/// Bodies to report on: of the label image, else those of the domain.
template <int Dim>
std::optional<LabelImage<Dim>> bodies_of(const RegisterInput<Dim>& input,
                                         const RegisterOutcome<Dim>& outcome) {
  if (input.labels) return *input.labels;
  if constexpr (Dim == 2) {
    if (outcome.domain && outcome.domain->has_bodies()) {
      return body_labels(*outcome.domain, input.fixed.image.raster());
    }
  }
  return std::nullopt;
}

}  // namespace

template <int Dim>
RegisterImages<Dim> make_images(const RegisterOptions& options, const RegisterInput<Dim>& input,
                                const Transform<Dim>& transform) {
  const Raster<Dim>& raster = input.fixed.image.raster();
  RegisterImages<Dim> images{transform_images(transform, raster), {}, {}, {}};
  const auto kind =
      options.interpolator == "linear" ? InterpolationKind::kLinear : InterpolationKind::kCubic;
  const auto warp = [&](const Image<float, Dim>& moving) {
    return resample(*make_interpolator(moving, kind), raster, row_map(images.displacement),
                    std::numeric_limits<float>::quiet_NaN());
  };
  images.warped = warp(input.moving.image);
  for (const auto& moving : input.further_moving) {
    images.further_warped.push_back(warp(moving.image));
  }
  const PointMap<Dim> stay = [](const Point<Dim>& x) { return x; };
  images.before = resample(*make_interpolator(input.moving.image, InterpolationKind::kLinear),
                           raster, stay, std::numeric_limits<float>::quiet_NaN());
  return images;
}

template <int Dim>
Evaluation<Dim> evaluate_outcome(const RegisterOptions& options, const RegisterInput<Dim>& input,
                                 const RegisterOutcome<Dim>& outcome,
                                 const RegisterImages<Dim>& images) {
  Mask<Dim> mask = images.domain;
  if (input.fixed_mask) {
    std::ranges::transform(mask.values(), input.fixed_mask->values(), mask.values().begin(),
                           [](std::uint8_t a, std::uint8_t b) -> std::uint8_t { return a && b; });
  }
  const auto bodies = bodies_of(input, outcome);
  EvaluationInput<Dim> parts;
  parts.displacement = &images.displacement;
  parts.determinants = &images.determinants;
  parts.mask = &mask;
  parts.labels = bodies ? &*bodies : nullptr;
  if (options.has_metric()) {
    parts.fixed = &input.fixed.image;
    parts.moving = &input.moving.image;
  }
  return evaluate(parts);
}

template <int Dim>
void write_results(const OutputFolder& output, const RegisterOptions& options,
                   const RegisterInput<Dim>& input, const RegisterOutcome<Dim>& outcome,
                   const RegisterImages<Dim>& images) {
  write_warped(output, "warped", options.moving.front(), input.moving, images.warped);
  for (std::size_t c = 1; c < options.num_channels(); ++c) {
    write_warped(output, message("warped-", c + 1), options.moving[c], input.further_moving[c - 1],
                 images.further_warped[c - 1]);
  }
  output.remove_numbered("warped", options.num_channels() + 1);
  output.write("displacement.mha",
               [&](const Path& file) { write_displacement_field(file, images.displacement); });
  output.write("jacobian.mha", [&](const Path& file) {
    write_image(file, images.determinants, PixelType::kFloat);
  });
  output.write("transform.json",
               [&](const Path& file) { save_transform(*outcome.transform, file); });
  if (has_itk_equivalent(*outcome.transform)) {
    output.write("transform.tfm",
                 [&](const Path& file) { save_itk_transform(*outcome.transform, file); });
  } else {
    output.remove("transform.tfm");
  }
}

template <int Dim>
void write_pictures(const OutputFolder& output, const RegisterOptions& options,
                    const RegisterInput<Dim>& input, const RegisterOutcome<Dim>& outcome,
                    const RegisterImages<Dim>& images,
                    std::vector<std::function<void()>> further_jobs) {
  const bool one_window = options.expects_equal_intensities();
  const Image<float, Dim>& fixed = input.fixed.image;
  DeformationDrawing<Dim> drawing;
  drawing.fixed_raster = fixed.raster();
  drawing.map = [&](const Point<Dim>& x) { return outcome.transform->map(x); };
  drawing.landmarks = input.landmarks;
  if constexpr (Dim == 2) {
    if (outcome.domain) drawing.feature_lines = outcome.domain->feature_lines;
  }
  const std::vector<NamedPicture> pictures = {
      {"fixed", [&] { return image_picture(fixed, "fixed"); }},
      {"moving", [&] { return image_picture(input.moving.image, "moving"); }},
      {"warped", [&] { return image_picture(images.warped, "moving, warped to the fixed image"); }},
      {"checkerboard", [&] { return checkerboard_picture(fixed, images.warped, one_window); }},
      {"difference", [&] { return difference_picture(fixed, images.before, images.warped); }},
      {"jacobian", [&] { return jacobian_picture(images.determinants); }},
      {"strain", [&] { return strain_picture(images.strain); }},
      {"grid", [&] { return deformation_picture(input.moving.image, drawing); }},
  };
  write_all(output, pictures, std::move(further_jobs));
}

#define CREASE_INSTANTIATE(Dim)                                                                    \
  template RegisterImages<Dim> make_images<Dim>(const RegisterOptions&, const RegisterInput<Dim>&, \
                                                const Transform<Dim>&);                            \
  template Evaluation<Dim> evaluate_outcome<Dim>(                                                  \
      const RegisterOptions&, const RegisterInput<Dim>&, const RegisterOutcome<Dim>&,              \
      const RegisterImages<Dim>&);                                                                 \
  template void write_results<Dim>(const OutputFolder&, const RegisterOptions&,                    \
                                   const RegisterInput<Dim>&, const RegisterOutcome<Dim>&,         \
                                   const RegisterImages<Dim>&);                                    \
  template void write_pictures<Dim>(const OutputFolder&, const RegisterOptions&,                   \
                                    const RegisterInput<Dim>&, const RegisterOutcome<Dim>&,        \
                                    const RegisterImages<Dim>&,                                    \
                                    std::vector<std::function<void()>>);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease

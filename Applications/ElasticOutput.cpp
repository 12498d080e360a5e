#include "Applications/ElasticOutput.h"

#include <algorithm>
#include <limits>

#include "Applications/ImageOutput.h"
#include "Core/Parallel.h"
#include "Images/MakeInterpolator.h"
#include "Registration/Elastic/StiffnessMap.h"
#include "Registration/Pictures.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using Path = std::filesystem::path;
constexpr float kOutside = std::numeric_limits<float>::quiet_NaN();

/// Determinants of the body alone: its continuation says nothing about tissue.
Image<float, 2> body_determinants(const ElasticImages& images) {
  Image<float, 2> determinants = images.determinants;
  for (std::size_t n = 0; n < determinants.values().size(); ++n) {
    if (images.domain.values()[n] == 0) determinants.values()[n] = kOutside;
  }
  return determinants;
}

/// The pairs as they were met, into the moving image as it is given.
Landmarks<2> given_pairs(const ElasticInput& input, const Landmarks<2>& pairs) {
  Landmarks<2> given = pairs;
  for (Point<2>& q : given.moving) q = input.to_given(q);
  return given;
}

}  // namespace

std::vector<FeatureLine> crease_lines(const CreasedDomain& domain) {
  std::vector<FeatureLine> lines;
  for (const FeatureChain& chain : domain.mesh.chains) {
    FeatureLine line;
    for (int v : chain.vertices) line.points.push_back(domain.mesh.mesh.vertices[v]);
    line.closed = chain.closed;
    line.name = chain.name;
    lines.push_back(std::move(line));
  }
  return lines;
}

ElasticImages make_images(const ElasticInput& input, const ElasticOutcome& outcome) {
  const Raster<2>& raster = input.fixed.image.raster();
  const auto moving = make_interpolator(input.moving.image, InterpolationKind::kCubic);
  ElasticImages images{transform_images(*outcome.registration.transform, raster), {}, {}, {}};
  images.warped = resample(*moving, raster, row_map(images.displacement), kOutside);
  const PointMap<2> stay = [](const Point<2>& x) { return x; };
  images.before = resample(*moving, raster, stay, kOutside);
  images.stiffness = stiffness_map(outcome.domain, outcome.material, raster);
  return images;
}

Evaluation<2> evaluate_outcome(const ElasticImages& images) {
  EvaluationInput<2> parts;
  parts.displacement = &images.displacement;
  parts.determinants = &images.determinants;
  parts.mask = &images.domain;
  return evaluate(parts);
}

std::optional<TargetErrors> target_errors(const ElasticInput& input,
                                          const ElasticOutcome& outcome) {
  if (!input.truth) return std::nullopt;
  const Raster<2>& raster = input.truth->raster();
  const auto& registration = outcome.registration;
  const SplineBasis<2>& body = *outcome.domain.basis;
  const auto errors_of = [&](const Transform<2>* transform) {
    std::vector<std::vector<double>> errors(static_cast<std::size_t>(raster.size[1]));
    parallel_for(raster.size[1], [&](std::int64_t j) {
      for (int i = 0; i < raster.size[0]; ++i) {
        const Point<2> x = raster.point({i, static_cast<double>(j)});
        const Vector<2>& truth = (*input.truth)(i, static_cast<int>(j));
        if (!body.contains(x) || !truth.allFinite()) continue;
        const Point<2> mapped = input.to_given(transform == nullptr ? x : transform->map(x));
        errors[static_cast<std::size_t>(j)].push_back((mapped - x - truth).norm());
      }
    });
    std::vector<double> all;
    for (const auto& row : errors) all.insert(all.end(), row.begin(), row.end());
    return error_statistics(std::move(all));
  };
  TargetErrors errors{errors_of(nullptr), errors_of(registration.deformation.get()), {}};
  if (registration.refinement) errors.by_images = errors_of(registration.transform.get());
  return errors;
}

void write_displacement(const OutputFolder& output, const ElasticInput& input,
                        DisplacementField<2> displacement) {
  if (input.mirrored) {
    const Raster<2>& raster = displacement.raster();
    for (std::int64_t k = 0; k < raster.num_samples(); ++k) {
      const auto [i, j] = displacement.index(k);
      const Point<2> x = raster.point({i, j});
      Vector<2>& u = displacement.values()[static_cast<std::size_t>(k)];
      u = input.to_given(x + u) - x;
    }
  }
  output.write("displacement.mha",
               [&](const Path& file) { write_displacement_field(file, displacement); });
}

void write_results(const OutputFolder& output, const ElasticCommandOptions& options,
                   const ElasticInput& input, const ElasticOutcome& outcome,
                   const ElasticImages& images) {
  write_warped(output, "warped", options.moving, input.moving, images.warped);
  output.write("jacobian.mha", [&](const Path& file) {
    write_image(file, images.determinants, PixelType::kFloat);
  });
  output.write("transform.json",
               [&](const Path& file) { save_transform(*outcome.transform, file); });
  output.write("pairs.csv",
               [&](const Path& file) { write_landmarks(file, given_pairs(input, outcome.pairs)); });
}

void write_pictures(const OutputFolder& output, const ElasticInput& input,
                    const ElasticOutcome& outcome, const ElasticImages& images,
                    std::vector<std::function<void()>> further_jobs) {
  const Image<float, 2>& fixed = input.fixed.image;
  DeformationDrawing<2> grid;
  grid.fixed_raster = fixed.raster();
  grid.map = [&](const Point<2>& x) { return outcome.registration.transform->map(x); };
  grid.landmarks = outcome.pairs;
  grid.feature_lines = crease_lines(outcome.domain);
  DeformationDrawing<2> mesh = grid;
  mesh.mesh = &outcome.domain.mesh.mesh;
  mesh.landmarks = {};
  const std::vector<NamedPicture> pictures = {
      {"fixed", [&] { return image_picture(fixed, "fixed"); }},
      {"moving", [&] { return image_picture(input.moving.image, "moving"); }},
      {"warped", [&] { return image_picture(images.warped, "moving, warped to the fixed image"); }},
      {"checkerboard", [&] { return checkerboard_picture(fixed, images.warped, true); }},
      {"difference",
       [&] { return difference_picture(fixed, images.before, images.warped, &images.domain); }},
      {"jacobian", [&] { return jacobian_picture(body_determinants(images)); }},
      {"stiffness", [&] { return stiffness_picture(images.stiffness); }},
      {"mesh", [&] { return deformation_picture(input.moving.image, mesh); }},
      {"grid", [&] { return deformation_picture(input.moving.image, grid); }},
  };
  write_all(output, pictures, std::move(further_jobs));
}

}  // namespace crease

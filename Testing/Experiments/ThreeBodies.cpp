// Experiment 2 of the dissertation's chapter 3: three rigid bodies in a soft background, images and exact
// landmarks; a tensor B-spline against triangular B-splines of as many control points, without and with
// creases.
#include "Images/IntensityRange.h"
#include "Optimizers/GaussNewton.h"
#include "Testing/Experiments/Experiment.h"
#include "Testing/Experiments/ExperimentPictures.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace {

using namespace crease;
using namespace crease::experiments;

constexpr int kCells = 8;
constexpr int kSize = 100;  // pixels

struct Outcome {  // NOLINT(bugprone-exception-escape): JSON's move does not throw
  Json figures;
  double image_ratio = 0, rigidity = 0, bending = 0, worst_body = 0, smallest_determinant = 0;
  double landmark_error = 0;
};

Outcome run(const Phantom& phantom, std::shared_ptr<const SplineBasis<2>> basis,
            const std::string& name, const std::filesystem::path& folder) {
  // The weights 10, 10 and 0.01 belong to lengths in the domain [0, 8]^2 and to greys from 0 to 1: undo
  // the scaling of lengths and of intensities.
  const double unit = kSize / static_cast<double>(kCells);
  const double range = intensity_percentiles(phantom.fixed).width();
  // The tensor spline has no regions: its rigid tissue is known by the labels.
  const auto& raster = phantom.labels.raster();
  const WeightField<2> rigid = [&](const Point<2>& x, int region) {
    if (region >= 0) return region > 0 ? 1.0 : 0.0;
    const Vector<2> index = raster.index(x);
    const auto nearest = [](double i) {
      return std::clamp(static_cast<int>(std::lround(i)), 0, kSize - 1);
    };
    return phantom.labels(nearest(index[0]), nearest(index[1])) > 0 ? 1.0 : 0.0;
  };
  Registration<2> registration(phantom.fixed, phantom.moving);
  registration.basis(std::move(basis))
      .initial({})
      .image_weight(10 * range * range)
      .energy("bending", 0.01 * unit * unit, bending<2>(rigid))
      .energy("rigidity", 10, rigidity<2>(rigid))
      .landmarks(phantom.landmarks)
      .optimizer(std::make_shared<GaussNewton>())
      .schedule({.levels = 1, .optical_flow = false, .smooth_finest = false});
  const auto result = registration.run();

  Outcome outcome;
  outcome.image_ratio = result.metric_after / result.metric_before;
  outcome.rigidity = result.energies.at("rigidity") / (unit * unit);
  outcome.bending = result.energies.at("bending");
  const JacobianRange jacobian = jacobian_range(*result.transform, phantom.fixed.raster());
  outcome.smallest_determinant = jacobian.min;
  Json bodies = Json::array();
  for (const auto& body : phantom.bodies) {
    const double rms = body_error(*result.transform, phantom, body).rms_mm;
    outcome.worst_body = std::max(outcome.worst_body, rms);
    bodies.push_back(rms);
  }
  for (double error : result.landmark_errors_mm) {
    outcome.landmark_error = std::max(outcome.landmark_error, error);
  }
  outcome.figures = {{"control_points", result.transform->num_parameters() / 2},
                     {"e_i", result.metric_after * range * range / (unit * unit)},
                     {"e_i_unregistered", result.metric_before * range * range / (unit * unit)},
                     {"e_r", outcome.rigidity},
                     {"e_s", outcome.bending},
                     {"body_rms_pixels", bodies},
                     {"det", {jacobian.min, jacobian.max}},
                     {"landmark_error_mm", outcome.landmark_error},
                     {"iterations", result.levels.back().iterations},
                     {"stopped_because", result.stopped_because}};
  write_pictures(folder, name, phantom, *result.transform);
  return outcome;
}

std::shared_ptr<const SplineBasis<2>> tensor_basis(const Phantom& phantom) {
  TensorLattice<2> lattice;
  lattice.spans = {22, 22};  // 25 x 25 control points
  lattice.origin = phantom.fixed.raster().bounds().lower;
  lattice.spacing = phantom.fixed.raster().bounds().size() / 22;
  return std::make_shared<TensorBSplineBasis<2>>(lattice);
}

}  // namespace

int main(int argc, char** argv) try {
  const auto folder = output_folder(argc, argv, "three-bodies-output");
  const Phantom phantom = make_phantom("bodies", {.size = kSize, .texture = false});
  const Outcome tensor = run(phantom, tensor_basis(phantom), "tensor", folder);
  const Outcome smooth =
      run(phantom, structured_basis(phantom, kCells, false), "no_creases", folder);
  const Outcome creased = run(phantom, structured_basis(phantom, kCells, true), "creases", folder);
  const double size = phantom.fixed.raster().bounds().diagonal();
  const Json figures = {{"experiment", 2},
                        {"tensor", tensor.figures},
                        {"without_creases", smooth.figures},
                        {"with_creases", creased.figures},
                        {"e_r_ratio", creased.rigidity / tensor.rigidity},
                        {"e_s_ratio", creased.bending / tensor.bending}};
  return finish(figures,
                {{"E_R with creases over tensor", creased.rigidity / tensor.rigidity, 0.2},
                 {"E_S with creases over tensor", creased.bending / tensor.bending, 0.4},
                 {"worst body with creases (pixels)", creased.worst_body, 0.05},
                 {"worst body with creases against tensor", creased.worst_body, tensor.worst_body},
                 {"smallest determinant", creased.smallest_determinant, 1e-3, true},
                 // The truth creases along the outlines, which shows in the blur of the bodies'
                 // edges: smooth splines cannot match it to the last.
                 {"E_I over unregistered, tensor", tensor.image_ratio, 0.003},
                 {"E_I over unregistered, no creases", smooth.image_ratio, 0.003},
                 {"E_I over unregistered, creases", creased.image_ratio, 0.001},
                 {"landmark error (mm)", creased.landmark_error, 1e-9 * size}});
} catch (const std::exception& error) {
  return give_up(error);
}

// Experiment 1 of the dissertation's chapter 3: a square is turned by 45 degrees by its landmarks alone,
// with and without creases along its outline. No image enters: energies and exact landmarks only.
#include "Optimizers/GaussNewton.h"
#include "Testing/Experiments/Experiment.h"
#include "Testing/Experiments/ExperimentPictures.h"

namespace {

using namespace crease;
using namespace crease::experiments;

constexpr int kCells = 6;

struct Outcome {  // NOLINT(bugprone-exception-escape): JSON's move does not throw
  Json figures;
  double rigidity = 0, bending = 0, smallest_determinant = 0, landmark_error = 0, body_rms = 0;
};

Outcome run(const Phantom& phantom, bool creases, const std::filesystem::path& folder) {
  // Energies in the units of the domain [0, 6]^2: lengths and E_R are scaled, E_S has no unit.
  const double unit = phantom.fixed.raster().size[0] / static_cast<double>(kCells);
  Registration<2> registration;
  registration.basis(structured_basis(phantom, kCells, creases))
      .energy("bending", unit * unit, bending<2>(body_weights<2>()))
      .energy("rigidity", 1, rigidity<2>())
      .landmarks(phantom.landmarks);
  const auto result = registration.run();

  Outcome outcome;
  outcome.rigidity = result.energies.at("rigidity") / (unit * unit);
  outcome.bending = result.energies.at("bending");
  const JacobianRange jacobian = jacobian_range(*result.transform, phantom.fixed.raster());
  outcome.smallest_determinant = jacobian.min;
  for (double error : result.landmark_errors_mm) {
    outcome.landmark_error = std::max(outcome.landmark_error, error);
  }
  const BodyError body = body_error(*result.transform, phantom, phantom.bodies.front());
  outcome.body_rms = body.rms_mm / unit;
  outcome.figures = {{"control_points", result.transform->num_parameters() / 2},
                     {"e_r", outcome.rigidity},
                     {"e_s", outcome.bending},
                     {"det", {jacobian.min, jacobian.max}},
                     {"body_rms", outcome.body_rms},
                     {"body_rms_gradient", body.rms_gradient},
                     {"landmark_error_mm", outcome.landmark_error},
                     {"iterations", result.levels.back().iterations},
                     {"stopped_because", result.stopped_because}};
  write_pictures(folder, creases ? "creases" : "no_creases", phantom, *result.transform);
  return outcome;
}

}  // namespace

int main(int argc, char** argv) try {
  const auto folder = output_folder(argc, argv, "rotated-square-output");
  const Phantom phantom = make_phantom("square", {.size = 400});
  const Outcome without = run(phantom, false, folder);
  const Outcome with = run(phantom, true, folder);
  const double size = phantom.fixed.raster().bounds().diagonal();
  const Json figures = {{"experiment", 1},
                        {"without_creases", without.figures},
                        {"with_creases", with.figures},
                        {"e_s_ratio", with.bending / without.bending},
                        {"e_r_ratio", with.rigidity / without.rigidity}};
  return finish(figures,
                {{"E_S with creases over without", with.bending / without.bending, 0.60},
                 {"E_R with creases over without", with.rigidity / without.rigidity, 0.01},
                 {"smallest determinant with creases", with.smallest_determinant, 1e-3, true},
                 {"landmark error with creases (mm)", with.landmark_error, 1e-9 * size},
                 {"landmark error without creases (mm)", without.landmark_error, 1e-9 * size},
                 {"distance of the body from the rotation", with.body_rms, 0.02}});
} catch (const std::exception& error) {
  return give_up(error);
}

// Experiment 3 of the dissertation's chapter 3: five vertebrae that move rigidly in soft tissue, creases
// along their outlines as found in the label image, four exact landmarks each; and the same with landmarks
// that are off by 1 mm and therefore soft.
#include "Registration/CreasedDomain.h"
#include "Testing/Experiments/Experiment.h"
#include "Testing/Experiments/ExperimentPictures.h"

namespace {

using namespace crease;
using namespace crease::experiments;

struct Outcome {  // NOLINT(bugprone-exception-escape): JSON's move does not throw
  Json figures;
  double worst_angle = 0, worst_shift = 0, rigidity_per_area = 0, ssd_left = 0;
  double smallest_determinant = 0, landmark_error = 0;
};

Outcome run(const Phantom& phantom, const CreasedDomain& domain, const LandmarkOptions& landmarks,
            const std::string& name, const std::filesystem::path& folder) {
  Registration<2> registration(phantom.fixed, phantom.moving);
  registration.basis(domain.basis)
      .energy("bending", default_bending_weight(*domain.basis), bending<2>(body_weights<2>()))
      .energy("rigidity", 10, rigidity<2>())
      .landmarks(phantom.landmarks, landmarks)
      .schedule({.adapt_weights = true});
  const auto result = registration.run();

  Outcome outcome;
  outcome.ssd_left = result.metric_after / result.metric_before;
  double area = 0;
  for (auto label : phantom.labels.values()) area += label > 0;
  outcome.rigidity_per_area = result.energies.at("rigidity") / area;
  const JacobianRange jacobian = jacobian_range(*result.transform, phantom.fixed.raster());
  outcome.smallest_determinant = jacobian.min;
  Json bodies = Json::array();
  for (const auto& body : phantom.bodies) {
    const BodyError error = body_error(*result.transform, phantom, body);
    outcome.worst_angle = std::max(outcome.worst_angle, error.angle_error_deg);
    outcome.worst_shift = std::max(outcome.worst_shift, error.shift_error_mm);
    bodies.push_back({{"angle_error_deg", error.angle_error_deg},
                      {"shift_error_mm", error.shift_error_mm},
                      {"rms_mm", error.rms_mm}});
  }
  Json levels = Json::array();
  for (const auto& level : result.levels) levels.push_back(level.iterations);
  for (double error : result.landmark_errors_mm) {
    outcome.landmark_error = std::max(outcome.landmark_error, error);
  }
  outcome.figures = {{"triangles", domain.mesh.mesh.simplices.size()},
                     {"control_points", domain.basis->num_control_points()},
                     {"free_parameters", result.free_parameters},
                     {"bodies", bodies},
                     {"e_r_per_area", outcome.rigidity_per_area},
                     {"e_s", result.energies.at("bending")},
                     {"ssd_reduction_percent", 100 * (1 - outcome.ssd_left)},
                     {"det", {jacobian.min, jacobian.max}},
                     {"landmark_error_mm", outcome.landmark_error},
                     {"iterations", levels},
                     {"timings_s", result.timings_s},
                     {"stopped_because", result.stopped_because}};
  write_pictures(folder, name, phantom, *result.transform);
  return outcome;
}

}  // namespace

int main(int argc, char** argv) try {
  const auto folder = output_folder(argc, argv, "spine-output");
  const Phantom exact = make_phantom("spine", {});
  const Phantom noisy = make_phantom("spine", {.landmark_noise_mm = 1});
  const CreasedDomain domain =
      make_creased_domain(rectangle_of(exact.labels.raster()), exact.labels, {},
                          {.edge_length = 40, .edge_length_near_lines = 12});
  const Outcome hard = run(exact, domain, {}, "exact", folder);
  const Outcome soft = run(noisy, domain, {.mode = LandmarkMode::kSoft}, "soft", folder);
  const double size = exact.fixed.raster().bounds().diagonal();
  const Json figures = {
      {"experiment", 3}, {"exact_landmarks", hard.figures}, {"soft_landmarks", soft.figures}};
  std::vector<Threshold> thresholds = {{"landmark error (mm)", hard.landmark_error, 1e-9 * size}};
  for (const auto& [name, outcome] :
       {std::pair{"exact landmarks", &hard}, {"soft landmarks", &soft}}) {
    const std::string with = std::string(", ") + name;
    thresholds.push_back({"shift of a body (mm)" + with, outcome->worst_shift, 0.25});
    thresholds.push_back({"angle of a body (degrees)" + with, outcome->worst_angle, 0.3});
    thresholds.push_back(
        {"smallest determinant" + with, outcome->smallest_determinant, 1e-3, true});
    thresholds.push_back({"E_R per area in bodies" + with, outcome->rigidity_per_area, 1e-4});
    thresholds.push_back({"SSD left" + with, outcome->ssd_left, 0.1});
  }
  return finish(figures, thresholds);
} catch (const std::exception& error) {
  return give_up(error);
}

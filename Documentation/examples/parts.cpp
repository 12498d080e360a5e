// parts PHANTOM OUTPUT: a registration composed part by part; Documentation/guide/library.md explains it.
#include <iostream>
#include <string>

#include "Images/ImageFile.h"
#include "Images/Resample.h"
#include "Optimizers/GaussNewton.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Evaluation.h"
#include "Registration/Pictures.h"
#include "Registration/Registration.h"
#include "Transforms/JacobianMap.h"
#include "Transforms/TransformFile.h"

int main(int argc, char** argv) try {
  using namespace crease;
  const std::string in = argc > 1 ? argv[1] : ".", out = argc > 2 ? argv[2] : ".";

  // Images: pixels and where they lie.
  const Image<float, 2> fixed = read_image<2>(in + "/fixed.mha").image;
  const Image<float, 2> moving = read_image<2>(in + "/moving.mha").image;
  const LabelImage<2> bones = read_labels<2>(in + "/labels.mha");

  // Domain: triangles whose edges follow the bones, knots that let the spline bend there.
  const CreasedDomain domain = make_creased_domain(rectangle_of(fixed.raster()), bones, {},
                                                   {.degree = 3, .edge_length = 40});
  std::cout << domain.plan << "\n";
  for (const std::string& warning : domain.warnings) std::cout << "warning: " << warning << "\n";

  // Transform: T(x) = A(x) + sum_i phi_i B_i(x); the basis B comes from the domain.
  Registration<2> registration(fixed, moving);
  registration.basis(domain.basis).alignment({.start = AlignmentStart::kLandmarks});

  // Metric: how alike the fixed image is to the moving one at the mapped points.
  registration.metric(ssd<2>()).interpolation(InterpolationKind::kCubic).image_weight(1);

  // Energies: soft tissue should bend little, bones not at all.
  const WeightField<2> rigid = body_weights<2>();
  registration.energy("bending", default_bending_weight(*domain.basis), bending<2>(rigid))
      .energy("rigidity", 1, rigidity<2>(rigid));

  // Constraints: landmarks that are met exactly, eliminated from the unknowns.
  registration.landmarks(read_landmarks<2>(in + "/landmarks.csv"), {.mode = LandmarkMode::kExact})
      .null_space(NullSpaceKind::kElimination);

  // Optimizer and schedule: how the minimum is sought, from coarse to fine.
  registration.optimizer(std::make_shared<GaussNewton>(
      OptimizerOptions{.relative_decrease = 1e-4, .max_iterations = 100}));
  registration.schedule({.levels = 3, .adapt_weights = true});

  // Run: the callback sees every iteration and may cancel.
  int iterations = 0;
  const RegistrationResult<2> result = registration.run([&](const RegistrationProgress& state) {
    if (state.stage == "level") ++iterations;
    return iterations < 10000;  // false would cancel
  });

  // Result: a map, and what is known about it.
  std::cout << "image term " << result.metric_before << " -> " << result.metric_after << "\n";
  for (const auto& [name, value] : result.energies) {
    const auto weight = result.weights.find(name);
    std::cout << name << " " << value;
    if (weight != result.weights.end()) std::cout << ", weight " << weight->second;
    std::cout << "\n";
  }
  const Point<2> x = domain.mesh.mesh.vertices.front();
  std::cout << "(" << x.transpose() << ") goes to (" << result.transform->map(x).transpose()
            << "), det grad T " << result.transform->spatial_jacobian(x).determinant() << "\n";
  save_transform(*result.transform, out + "/transform.json");

  // Evaluation: against the truth, which a phantom has.
  DisplacementField<2> displacement(fixed.raster());
  for (std::int64_t i = 0; i < fixed.raster().num_samples(); ++i) {
    const auto [column, row] = fixed.index(i);
    const Point<2> p = fixed.raster().point({double(column), double(row)});
    displacement(column, row) = result.transform->map(p) - p;
  }
  const DisplacementField<2> truth = read_displacement_field<2>(in + "/truth.mha");
  const Evaluation<2> evaluation =
      evaluate<2>({.displacement = &displacement, .truth = &truth, .labels = &bones});
  std::cout << "mean error " << evaluation.error->mean << " mm\n";
  for (const auto& body : evaluation.bodies) {
    std::cout << "body " << body.label << " turned by " << body.angle_deg << " degrees, "
              << body.rms_nonrigidity_mm << " mm from rigid\n";
  }

  // Pictures: the mesh where it lies in the fixed image, and where T carries it.
  DeformationDrawing<2> drawing;
  drawing.mesh = &domain.mesh.mesh;
  drawing.feature_lines = domain.feature_lines;
  drawing.fixed_raster = fixed.raster();
  drawing.map = [](const Point<2>& p) { return p; };
  write_picture(out + "/mesh.png", deformation_picture(fixed, drawing));
  drawing.map = [&](const Point<2>& p) { return result.transform->map(p); };
  write_picture(out + "/mapped-mesh.png", deformation_picture(moving, drawing));
  return evaluation.error->mean < 1 ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}

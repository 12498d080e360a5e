// Registration on Powell-Sabin splines: the domains of creased splines, with other splines on their mesh.
#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Registration/CreasedDomain.h"
#include "Registration/LandmarkConstraints.h"
#include "Registration/Phantoms/Phantom.h"
#include "Registration/Registration.h"
#include "Testing/Transforms/Domains/SampleDomains.h"
#include "Transforms/Splines/PowellSabinBasis.h"

namespace crease {
namespace {

constexpr CreasedDomainOptions kSizes = {
    .spline = TriangleSpline::kPowellSabin, .edge_length = 30, .edge_length_near_lines = 12};

CreasedDomain domain_of(const Phantom& phantom, TriangleSpline spline, bool creases = true) {
  CreasedDomainOptions options = kSizes;
  options.spline = spline;
  options.creases = creases;
  return make_creased_domain(rectangle_of(phantom.fixed.raster()), phantom.labels, {}, options);
}

}  // namespace

TEST(PowellSabinDomain, HasTheMeshAndTheBodiesOfTheCreasedOne) {
  const Phantom phantom = make_phantom("bodies", {.size = 128});
  const auto creased = domain_of(phantom, TriangleSpline::kTriangular);
  const auto domain = domain_of(phantom, TriangleSpline::kPowellSabin);
  EXPECT_EQ(domain.mesh.mesh.vertices, creased.mesh.mesh.vertices);
  EXPECT_EQ(domain.mesh.mesh.simplices, creased.mesh.mesh.simplices);
  EXPECT_EQ(domain.mesh.mesh.regions, creased.mesh.mesh.regions);
  EXPECT_TRUE(domain.has_bodies());
  EXPECT_TRUE(domain.plan.vertices.empty());
  const auto& raster = phantom.fixed.raster();
  EXPECT_TRUE(std::ranges::equal(body_labels(domain, raster).values(),
                                 body_labels(creased, raster).values()));
  const auto& basis = dynamic_cast<const PowellSabinBasis&>(*domain.basis);
  EXPECT_EQ(basis.net().crease_edges.size(), creased.triangular_basis().net().crease_edges.size());
  EXPECT_GT(basis.num_control_points(), 3 * std::ssize(domain.mesh.mesh.vertices));
  const auto smooth = domain_of(phantom, TriangleSpline::kPowellSabin, false);
  EXPECT_EQ(smooth.basis->num_control_points(), 3 * std::ssize(domain.mesh.mesh.vertices));
  EXPECT_EQ(basis.net().mesh.regions, domain.mesh.mesh.regions);
  EXPECT_THROW(domain.triangular_basis(), InvalidInput);
  EXPECT_EQ(&creased.triangular_basis(), creased.basis.get());
}

// Three bodies that move on their own: rigidity by labels holds them together, and with creases the map comes
// much nearer to the true one.
TEST(PowellSabinDomain, RegistersBodies) {
  const Phantom phantom = make_phantom("bodies", {.size = 96});
  const auto run = [&](const CreasedDomain& domain, double weight) {
    Registration<2> registration(phantom.fixed, phantom.moving);
    registration.basis(domain.basis)
        .energy("bending", default_bending_weight(*domain.basis),
                bending<2>(weight > 0 ? body_weights<2>() : nullptr))
        .landmarks(phantom.landmarks);
    if (weight > 0) registration.energy("rigidity", weight, rigidity<2>(body_weights<2>()));
    return registration.run().transform;
  };
  const CreasedDomain domain = domain_of(phantom, TriangleSpline::kPowellSabin);
  const auto creased = run(domain, 1), soft = run(domain, 0);
  const auto smooth = run(domain_of(phantom, TriangleSpline::kPowellSabin, false), 1);
  // Of lengths in bodies, and of the map: root mean square over every other pixel.
  const auto figures = [&](const Transform<2>& transform) {
    double stretch = 0, in_bodies = 0, error = 0, all = 0;
    for (int j = 0; j < 96; j += 2) {
      for (int i = 0; i < 96; i += 2) {
        const Point<2> x(i, j);
        error += (transform.map(x) - phantom.truth(x)).squaredNorm();
        ++all;
        if (phantom.labels(i, j) == 0) continue;
        const Matrix<2> f = transform.spatial_jacobian(x);
        stretch += (f.transpose() * f - Matrix<2>::Identity()).squaredNorm();
        ++in_bodies;
      }
    }
    return std::pair(std::sqrt(stretch / in_bodies), std::sqrt(error / all));
  };
  const auto [strain, error] = figures(*creased);
  const auto [soft_strain, soft_error] = figures(*soft);
  const auto [smooth_strain, smooth_error] = figures(*smooth);
  EXPECT_LT(strain, 0.05);
  EXPECT_LT(strain, 0.5 * soft_strain);
  EXPECT_LT(error, 0.7 * smooth_error) << "soft: " << soft_error << ", " << smooth_strain;
}

TEST(PowellSabinDomain, DividesTrianglesWhoseLandmarksContradictEachOther) {
  const auto region = testing::rectangle(0, 0, 100, 100);
  const CreasedDomainOptions coarse = {.spline = TriangleSpline::kPowellSabin, .edge_length = 20};
  Landmarks<2> landmarks;
  for (int k = 0; k < 25; ++k) {
    const int row = k / 5;
    landmarks.fixed.emplace_back(50 + 1.3 * (k % 5), 45 + 1.1 * row);
    landmarks.moving.emplace_back(landmarks.fixed.back() +
                                  Vector<2>(0.3 * std::sin(3.0 * k), 0.1 * k));
  }
  const auto before = make_creased_domain(region, {}, coarse);
  ASSERT_TRUE(find_contradiction(landmarks, *before.basis, LandmarkMode::kExact).has_value());
  CreasedDomainOptions options = coarse;
  options.landmarks = landmarks;
  const auto after = make_creased_domain(region, {}, options);
  EXPECT_FALSE(find_contradiction(landmarks, *after.basis, LandmarkMode::kExact).has_value());
  EXPECT_GT(after.mesh.mesh.simplices.size(), before.mesh.mesh.simplices.size());
}

}  // namespace crease

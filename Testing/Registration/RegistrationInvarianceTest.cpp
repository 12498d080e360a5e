// What must not change a registration: the number of threads, the order of the coordinates, and how the
// mesh is numbered.
#include <gtest/gtest.h>

#include <numeric>

#include "Core/Parallel.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Phantoms/Phantom.h"
#include "Registration/Registration.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"

namespace crease {
namespace {

/// Three bodies that move on their own, with creases along their outlines.
struct Bodies {
  Phantom phantom = make_phantom("bodies", {.size = 96});
  CreasedDomain domain = make_creased_domain(rectangle_of(phantom.fixed.raster()), phantom.labels,
                                             {}, {.edge_length = 40, .edge_length_near_lines = 16});
};

/// A problem that exists in several equivalent forms.
struct Problem {
  Image<float, 2> fixed, moving;
  KnotNet<2> net;
  Landmarks<2> landmarks;

  std::shared_ptr<const Transform<2>> solve(bool with_images) const {
    Registration<2> registration = with_images ? Registration<2>(fixed, moving) : Registration<2>();
    registration.basis(std::make_shared<TriangularBSplineBasis<2>>(net))
        .initial({})
        .energy("bending", 0.1, bending<2>(body_weights<2>()))
        .energy("rigidity", 1, rigidity<2>())
        .landmarks(landmarks)
        .schedule({.optical_flow = false});  // a start that prefers neither axis
    return registration.run().transform;
  }
};

Problem problem() {
  const Bodies bodies;
  return {bodies.phantom.fixed, bodies.phantom.moving, bodies.domain.triangular_basis().net(),
          bodies.phantom.landmarks};
}

Point<2> swapped(const Point<2>& p) { return {p[1], p[0]}; }

Image<float, 2> swapped(const Image<float, 2>& image) {
  Image<float, 2> result(image.raster());  // square, 1 mm
  for (int j = 0; j < image.size()[1]; ++j) {
    for (int i = 0; i < image.size()[0]; ++i) result(i, j) = image(j, i);
  }
  return result;
}

Problem swapped(Problem problem) {
  problem.fixed = swapped(problem.fixed);
  problem.moving = swapped(problem.moving);
  for (auto& v : problem.net.mesh.vertices) v = swapped(v);
  for (auto& s : problem.net.mesh.simplices) std::swap(s[1], s[2]);
  for (auto& cloud : problem.net.clouds) {
    for (auto& knot : cloud) knot = swapped(knot);
  }
  for (auto& p : problem.landmarks.fixed) p = swapped(p);
  for (auto& p : problem.landmarks.moving) p = swapped(p);
  return problem;
}

Problem renumbered(Problem problem) {
  problem.net = testing::renumbered(problem.net);
  std::ranges::reverse(problem.landmarks.fixed);
  std::ranges::reverse(problem.landmarks.moving);
  return problem;
}

/// Over the samples of the phantom, mm.
template <typename A, typename B>
double largest_difference(const A& a, const B& b) {
  double largest = 0;
  for (int j = 0; j < 96; j += 3) {
    for (int i = 0; i < 96; i += 3) {
      const Point<2> x(i, j);
      largest = std::max(largest, (a(x) - b(x)).norm());
    }
  }
  return largest;
}

/// Tolerances in mm for a domain of 96 mm: 1e-9 of it in double precision; with images, 1e-7, for the
/// image term maps, compares and carries back in single precision, whose rounding changes with the order.
constexpr double kWithoutImages = 1e-9 * 96, kWithImages = 1e-7 * 96;

/// The parameters that `run` finds are the same, bit by bit, on 1, 2 and 8 threads.
template <typename Run>
void expect_same_bytes(const Run& run) {
  Eigen::VectorXd one;
  for (int threads : {1, 2, 8}) {
    set_num_threads(threads);
    const Eigen::VectorXd found = run();
    set_num_threads(0);
    if (threads == 1) one = found;
    EXPECT_GT(found.norm(), 0);
    EXPECT_TRUE(found == one) << threads << " threads";
  }
}

}  // namespace

TEST(RegistrationInvariance, SwappedCoordinatesGiveTheSame) {
  const Problem plain = problem(), other = swapped(plain);
  for (const bool with_images : {false, true}) {
    const auto a = plain.solve(with_images), b = other.solve(with_images);
    EXPECT_LT(largest_difference([&](const Point<2>& x) { return a->map(x); },
                                 [&](const Point<2>& x) { return swapped(b->map(swapped(x))); }),
              with_images ? kWithImages : kWithoutImages);
  }
}

TEST(RegistrationInvariance, RenumberedMeshesGiveTheSame) {
  const Problem plain = problem(), other = renumbered(plain);
  for (const bool with_images : {false, true}) {
    const auto a = plain.solve(with_images), b = other.solve(with_images);
    EXPECT_LT(largest_difference([&](const Point<2>& x) { return a->map(x); },
                                 [&](const Point<2>& x) { return b->map(x); }),
              with_images ? kWithImages : kWithoutImages);
  }
}

TEST(RegistrationInvariance, ThreadsDoNotChangeABit) {
  const Phantom blobs = make_phantom("blobs", {.size = 128});
  expect_same_bytes([&] {
    return Registration<2>(blobs.fixed, blobs.moving)
        .basis(testing::tensor_over<2>(blobs.fixed.raster().bounds(), 8, 3))
        .energy("bending", 0.1, bending<2>())
        .run()
        .transform->parameters();
  });
}

TEST(RegistrationInvariance, ThreadsDoNotChangeABitOfCreasedMaps) {
  expect_same_bytes([] {  // meshing and binding included
    const Bodies bodies;
    return Registration<2>(bodies.phantom.fixed, bodies.phantom.moving)
        .basis(bodies.domain.basis)
        .alignment({.search = AlignmentSearch::kRigid})
        .energy("bending", 0.1, bending<2>(body_weights<2>()))
        .energy("rigidity", 1, rigidity<2>())
        .landmarks(bodies.phantom.landmarks)
        .run()
        .transform->parameters();
  });
}

TEST(RegistrationInvariance, ThreadsDoNotChangeABitInSpace) {
  const auto raster = testing::raster_of<3>(32);
  const auto fixed = testing::image_of<3>(raster, [](const Point<3>& x) {
    return Point<3>(x + Vector<3>(0.5, -0.4, 0.6) * std::sin(0.1 * x[0]));
  });
  const auto moving = testing::scene_image<3>(raster);
  expect_same_bytes([&] {
    return Registration<3>(fixed, moving)
        .basis(testing::tensor_over<3>(raster.bounds(), 3, 3))
        .energy("bending", 0.1, bending<3>())
        .run()
        .transform->parameters();
  });
}

}  // namespace crease

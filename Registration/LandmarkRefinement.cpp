#include "Registration/LandmarkRefinement.h"

#include <set>

#include "Core/Error.h"
#include "Registration/LandmarkConstraints.h"
#include "Transforms/Splines/KnotLocator.h"

namespace crease {
namespace {

constexpr int kMostRounds = 4;
constexpr double kWantedStrain = 10;  // once triangles are divided

/// The disc round the triangle that holds p, with half the mean of its edges.
FineDisc halved_triangle(const CreasedDomain& domain, const Point<2>& p) {
  const SimplexMesh<2>& mesh = domain.mesh.mesh;
  const KnotLocator<2> locator(mesh, kKnotTie * mesh_scale(mesh));
  const auto& corners = mesh.simplices[static_cast<std::size_t>(locator.find(p))];
  FineDisc disc;
  for (int k = 0; k < 3; ++k) {
    const Point<2>&a = mesh.vertices[corners[k]], &b = mesh.vertices[corners[(k + 1) % 3]];
    disc.centre += a / 3;
    disc.edge_length += (b - a).norm() / 6;
  }
  for (int corner : corners) {
    disc.radius = std::max(disc.radius, (mesh.vertices[corner] - disc.centre).norm());
  }
  return disc;
}

/// What dividing the triangles that hold the landmarks has done so far.
struct Refinement {
  std::set<int> landmarks;
  int rounds = 0;
  double old_length = 0;  // mm, mean over the landmarks of the first contradiction
  std::size_t old_triangles = 0;

  std::string text(double new_length, const CreasedDomain& domain) const {
    return message("the triangles that hold ", landmarks.size(),
                   " exact landmarks which contradict each other, or nearly, were divided ", rounds,
                   rounds == 1 ? " time" : " times", ": edges of ", old_length, " mm became ",
                   new_length, " mm, ", old_triangles, " triangles ",
                   domain.mesh.mesh.simplices.size());
  }
};

}  // namespace

CreasedDomain refined_for_landmarks(const Landmarks<2>& landmarks, const DomainMaker& make) {
  constexpr LandmarkMode kExact = LandmarkMode::kExact;
  std::vector<FineDisc> discs;
  CreasedDomain domain = make(discs);
  Refinement done;
  const auto mean_edge = [&] {
    double sum = 0;
    for (int j : done.landmarks) {
      sum += 2 * halved_triangle(domain, landmarks.fixed[j]).edge_length;
    }
    return sum / static_cast<double>(done.landmarks.size());
  };
  auto found = find_contradiction(landmarks, *domain.basis, kExact);
  while (done.rounds < kMostRounds) {
    const double most = done.rounds == 0 ? kLargestLandmarkStrain : kWantedStrain;
    const std::vector<int> cluster =
        found ? found->landmarks
              : landmark_strain(landmarks, *domain.basis, kExact, most).landmarks;
    if (cluster.empty()) break;
    done.landmarks.insert(cluster.begin(), cluster.end());
    if (done.rounds == 0) {
      done.old_length = mean_edge();
      done.old_triangles = domain.mesh.mesh.simplices.size();
    }
    for (int j : cluster) discs.push_back(halved_triangle(domain, landmarks.fixed[j]));
    domain = make(discs);
    ++done.rounds;
    found = find_contradiction(landmarks, *domain.basis, kExact);
  }
  if (done.rounds == 0) return domain;
  const std::string text = done.text(mean_edge(), domain);
  if (found) {
    throw InvalidInput(message(
        found->text, "; ", text,
        ", which did not help: give them a sigma (soft landmarks), delete some, or accept the "
        "least-squares compromise (--landmarks-conflict compromise)"));
  }
  domain.warnings.push_back(text);
  return domain;
}

}  // namespace crease

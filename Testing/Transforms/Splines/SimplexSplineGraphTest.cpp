#include "Transforms/Splines/SimplexSplineGraph.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "Testing/Transforms/Splines/ReferenceVectors.h"
#include "Testing/Transforms/Splines/TestNets.h"

namespace crease {
namespace {

template <int Dim>
MultiIndex<Dim> multi_index(const nlohmann::json& array) {
  MultiIndex<Dim> beta;
  for (int j = 0; j <= Dim; ++j) beta[j] = array[j].get<int>();
  return beta;
}

// Largest errors over a file, and the largest entries.
struct Errors {
  double error[3] = {}, scale[3] = {};
  template <typename Vector>
  void add(int order, const Vector& found, const std::vector<double>& truth) {
    for (std::size_t i = 0; i < truth.size(); ++i) {
      error[order] = std::max(error[order], std::abs(found[i] - truth[i]));
      scale[order] = std::max(scale[order], std::abs(truth[i]));
    }
  }
};

template <int Dim>
void check_mesh(const nlohmann::json& file) {
  SimplexMesh<Dim> mesh;
  mesh.vertices = testing::points<Dim>(file["vertices"]);
  for (const auto& simplex : file["simplices"]) mesh.simplices.push_back(multi_index<Dim>(simplex));
  std::vector<std::vector<Point<Dim>>> clouds;
  for (const auto& cloud : file["clouds"]) clouds.push_back(testing::points<Dim>(cloud));
  const SimplexSplineGraph<Dim> graph(mesh, clouds, file["degree"]);
  std::vector<int> all(mesh.simplices.size());
  std::iota(all.begin(), all.end(), 0);

  Errors basis, spline;
  for (const auto& p : file["points"]) {
    const auto u = testing::point<Dim>(p["u"]);
    const auto directions = testing::points<Dim>(p["directions"]);
    std::map<std::pair<int, int>, SplineJet<Dim>> found;
    SplineJet<Dim> sum;
    for (const auto& f : graph.evaluate(u, directions, all, 2)) {
      found[{f.simplex, f.index}] = f.jet;
      // The file lists its multi-indices in the order of multi_index_position.
      const double c = testing::numbers(file["coefficients"][f.simplex])[f.index];
      sum.value += c * f.jet.value;
      sum.gradient += c * f.jet.gradient;
      sum.hessian += c * f.jet.hessian;
    }
    spline.add(0, Eigen::Matrix<double, 1, 1>(sum.value),
               {std::stod(p["spline"]["value"].get<std::string>())});
    spline.add(1, sum.gradient, testing::numbers(p["spline"]["grad"]));
    spline.add(2, sum.hessian, testing::numbers(p["spline"]["hess"]));
    for (const auto& entry : p["basis"]) {
      const std::pair<int, int> key(entry["simplex"],
                                    multi_index_position<Dim>(multi_index<Dim>(entry["beta"])));
      const SplineJet<Dim> jet = found.count(key) ? found[key] : SplineJet<Dim>();
      basis.add(0, Eigen::Matrix<double, 1, 1>(jet.value),
                {std::stod(entry["N"].get<std::string>())});
      basis.add(1, jet.gradient, testing::numbers(entry["grad"]));
      basis.add(2, jet.hessian, testing::numbers(entry["hess"]));
      found.erase(key);
    }
    for (const auto& [key, jet] : found) {  // all others are zero
      basis.add(0, Eigen::Matrix<double, 1, 1>(jet.value), {0.0});
      basis.add(1, jet.gradient, std::vector<double>(Dim, 0.0));
      basis.add(2, jet.hessian, std::vector<double>(kNumSecondDerivatives<Dim>, 0.0));
    }
  }
  const double tolerance[3] = {1e-13, 1e-12, 1e-11};
  for (int order = 0; order < 3; ++order) {
    EXPECT_LE(basis.error[order], tolerance[order] * basis.scale[order])
        << file["name"] << ", basis, derivative " << order;
    EXPECT_LE(spline.error[order], tolerance[order] * spline.scale[order])
        << file["name"] << ", spline, derivative " << order;
  }
}

template <int Dim>
void check_files() {
  const auto files = testing::reference_vectors("dms_mesh", Dim);
  if (files.empty()) GTEST_SKIP() << "no test vectors";
  for (const auto& file : files) check_mesh<Dim>(file);
}

TEST(SimplexSplineGraph, MatchesExactValuesInThePlane) { check_files<2>(); }
TEST(SimplexSplineGraph, MatchesExactValuesInSpace) { check_files<3>(); }

// The graph shares and prunes; the recurrence of one function alone does not.
template <int Dim>
void compare_with_recurrence(const KnotNet<Dim>& net, int seed) {
  const SimplexSplineGraph<Dim> graph(net.mesh, net.clouds, net.degree);
  std::vector<int> all(net.mesh.simplices.size());
  std::iota(all.begin(), all.end(), 0);
  for (const Point<Dim>& u : testing::points_inside(net.mesh, 3, seed)) {
    const auto flag = flag_towards<Dim>(net.mesh.vertices[0], u);
    for (const auto& f : graph.evaluate(u, flag, all, 2)) {
      const auto expected = testing::local_function<Dim>(net, f.simplex, f.index, u, flag);
      EXPECT_NEAR(f.jet.value, expected.value, 1e-12);
      EXPECT_LT((f.jet.gradient - expected.gradient).norm(), 1e-10);
      EXPECT_LT((f.jet.hessian - expected.hessian).norm(), 1e-8);
    }
  }
}

TEST(SimplexSplineGraph, AgreesWithPlainRecurrence) {
  for (int degree = 1; degree <= 4; ++degree) {
    compare_with_recurrence<2>(testing::jittered_net(2, 2, degree, 0.4, degree), degree);
  }
  compare_with_recurrence<3>(testing::tetrahedral_net(2, 0.4), 4);
}

}  // namespace
}  // namespace crease

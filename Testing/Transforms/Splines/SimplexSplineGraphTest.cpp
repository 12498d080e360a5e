#include "Transforms/Splines/SimplexSplineGraph.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "Core/Error.h"
#include "Testing/Transforms/Splines/JetErrors.h"
#include "Testing/Transforms/Splines/ReferenceVectors.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

template <int Dim>
MultiIndex<Dim> multi_index(const nlohmann::json& array) {
  MultiIndex<Dim> beta;
  for (int j = 0; j <= Dim; ++j) beta[j] = array[j].get<int>();
  return beta;
}

template <int Dim>
SplineJet<Dim> jet_of(const nlohmann::json& entry, const char* value) {
  SplineJet<Dim> jet;
  jet.value = std::stod(entry[value].get<std::string>());
  jet.gradient = Eigen::Map<const Vector<Dim>>(testing::numbers(entry["grad"]).data());
  jet.hessian = Eigen::Map<const typename SplineJet<Dim>::SecondDerivatives>(
      testing::numbers(entry["hess"]).data());
  return jet;
}

/// A mesh of the reference vectors.
template <int Dim>
struct ReferenceMesh {
  explicit ReferenceMesh(const nlohmann::json& file) : degree(file["degree"]) {
    mesh.vertices = testing::points<Dim>(file["vertices"]);
    for (const auto& s : file["simplices"]) mesh.simplices.push_back(multi_index<Dim>(s));
    for (const auto& cloud : file["clouds"]) clouds.push_back(testing::points<Dim>(cloud));
    for (const auto& of_simplex : file["coefficients"]) {
      const auto values = testing::numbers(of_simplex);
      coefficients.emplace_back(values.size());
      for (std::size_t k = 0; k < values.size(); ++k) {
        const auto beta = multi_index<Dim>(file["beta_order"][k]);
        coefficients.back()[multi_index_position<Dim>(beta)] = values[k];
      }
    }
  }
  int degree;
  SimplexMesh<Dim> mesh;
  std::vector<std::vector<Point<Dim>>> clouds;    // degree + 1 knots each
  std::vector<std::vector<double>> coefficients;  // per simplex, by multi_index_position
};

template <int Dim>
void add(const SplineJet<Dim>& found, const SplineJet<Dim>& truth, testing::JetErrors& errors) {
  errors.add<Dim>(found, truth.value, {truth.gradient.begin(), truth.gradient.end()},
                  {truth.hessian.begin(), truth.hessian.end()});
}

template <int Dim>
void check_graph(const nlohmann::json& file) {
  const ReferenceMesh<Dim> reference(file);
  const SimplexSplineGraph<Dim> graph(reference.mesh, reference.clouds, reference.degree);
  std::vector<int> all(reference.mesh.simplices.size());
  std::iota(all.begin(), all.end(), 0);

  testing::JetErrors basis, spline;
  for (const auto& p : file["points"]) {
    const auto u = testing::point<Dim>(p["u"]);
    const auto directions = testing::points<Dim>(p["directions"]);
    std::map<std::pair<int, int>, SplineJet<Dim>> found;
    SplineJet<Dim> sum;
    for (const auto& f : graph.evaluate(u, directions, all, 2)) {
      found[{f.simplex, f.index}] = f.jet;
      const double c = reference.coefficients[f.simplex][f.index];
      sum.value += c * f.jet.value;
      sum.gradient += c * f.jet.gradient;
      sum.hessian += c * f.jet.hessian;
    }
    add<Dim>(sum, jet_of<Dim>(p["spline"], "value"), spline);
    for (const auto& entry : p["basis"]) {
      const std::pair<int, int> key(entry["simplex"],
                                    multi_index_position<Dim>(multi_index<Dim>(entry["beta"])));
      add<Dim>(found[key], jet_of<Dim>(entry, "N"), basis);
      found.erase(key);
    }
    for (const auto& [key, jet] : found) add<Dim>(jet, {}, basis);  // all others are zero
  }
  basis.expect_small(message(file["name"], ", basis"));
  spline.expect_small(message(file["name"], ", spline"));
}

template <int Dim>
void check_files() {
  const auto files = testing::reference_vectors("dms_mesh", Dim);
  if (files.empty()) GTEST_SKIP() << "no test vectors";
  for (const auto& file : files) check_graph<Dim>(file);
}

TEST(SimplexSplineGraph, MatchesExactValuesInThePlane) { check_files<2>(); }
TEST(SimplexSplineGraph, MatchesExactValuesInSpace) { check_files<3>(); }

// The basis has no last knots: they cancel in the sum. Clouds that reach into the domain it refuses.
TEST(SimplexSplineGraph, BasisMatchesExactSplines) {
  const auto files = testing::reference_vectors("dms_mesh", 2);
  if (files.empty()) GTEST_SKIP() << "no test vectors";
  int checked = 0;
  for (const auto& file : files) {
    const ReferenceMesh<2> reference(file);
    KnotNet<2> net{reference.degree, reference.mesh, reference.clouds, {}};
    for (auto& cloud : net.clouds) cloud.pop_back();
    std::unique_ptr<TriangularBSplineBasis<2>> basis;
    try {
      basis = std::make_unique<TriangularBSplineBasis<2>>(net);
    } catch (const InvalidInput&) {
      continue;
    }
    ++checked;
    Eigen::VectorXd c(basis->num_control_points());
    for (std::size_t t = 0; t < reference.mesh.simplices.size(); ++t) {
      const auto control_points = basis->control_points_of(static_cast<int>(t));
      for (std::size_t k = 0; k < control_points.size(); ++k) {
        c[control_points[k]] = reference.coefficients[t][k];
      }
    }
    testing::JetErrors errors;
    for (const auto& p : file["points"]) {
      const auto u = testing::point<2>(p["u"]);
      if (basis->find_simplex(u) != p["simplex"]) continue;  // on an edge, seen from the other side
      const auto b = basis->evaluate(u, 2);
      SplineJet<2> sum;
      for (std::size_t i = 0; i < b.control_points.size(); ++i) {
        sum.value += c[b.control_points[i]] * b.values[i];
        sum.gradient += c[b.control_points[i]] * b.gradients.col(i);
        sum.hessian += c[b.control_points[i]] * b.hessians.col(i);
      }
      add<2>(sum, jet_of<2>(p["spline"], "value"), errors);
    }
    errors.expect_small(message(file["name"], ", basis without last knots"));
  }
  EXPECT_GE(checked, 3);
}

// Each function by itself, not only those that neighbours share.
TEST(SimplexSplineGraph, FunctionsAreNotNegative) {
  for (int degree = 1; degree <= 5; ++degree) {
    for (const auto& net : {testing::within_eight(testing::jittered_net(3, 3, degree, 0.5, 2)),
                            testing::within_eight(testing::straight_crease_net(degree, 0.4)),
                            testing::ring_net(degree, 0.4, true)}) {
      const SimplexSplineGraph<2> graph(net.mesh, net.clouds, degree);
      const KnotLocator<2> locator(net.mesh, kKnotTie * mesh_scale(net.mesh));
      const auto neighbours = vertex_neighbours(net.mesh);
      auto points = testing::special_points(net);
      for (const auto& p : testing::points_inside(net.mesh, 6, 3)) points.push_back(p);
      for (const auto& u : points) {
        const int holder = locator.find(u);
        const auto flag = flag_towards<2>(simplex_centroid(net.mesh, holder), u);
        for (const auto& f : graph.evaluate(u, flag, neighbours[holder], 0)) {
          EXPECT_GT(f.jet.value, -1e-12) << "degree " << degree;
        }
      }
    }
  }
}

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

#include "Transforms/Splines/PowellSabinBasis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>

#include "Core/Error.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Testing/Transforms/Splines/PowellSabinMeshes.h"
#include "Transforms/Domains/ConvexPolygon.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/SplineProjection.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/PowellSabinSides.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Random points, and all corners and edges' middles of the small triangles.
std::vector<Point<2>> points_of(const PowellSabinBasis& basis) {
  auto points = testing::points_inside(basis.net().mesh, 12, 5);
  for (std::size_t t = 0; t < basis.net().mesh.simplices.size(); ++t) {
    for (int c = 0; c < PowellSabinPatch::kNumCells; ++c) {
      const auto corners = basis.patch(static_cast<int>(t)).cell(c);
      for (int k = 0; k < 3; ++k) {
        points.push_back(corners[k]);
        points.emplace_back(0.5 * (corners[k] + corners[(k + 1) % 3]));
      }
    }
  }
  return points;
}

struct Jet {
  double value;
  Vector<2> gradient;
  Vector<3> hessian;
};

Jet spline(const PowellSabinBasis& basis, const Eigen::VectorXd& c, const Point<2>& x) {
  const auto b = basis.evaluate(x, 2);
  const Eigen::VectorXd own = c(b.control_points);
  return {b.values.dot(own), b.gradients * own, b.hessians * own};
}

// The same by the polynomials of one small triangle, whether it holds x or not.
Jet polynomial(const PowellSabinBasis& basis, const Eigen::VectorXd& c, int triangle, int cell,
               const Point<2>& x) {
  const auto& patch = basis.patch(triangle);
  const auto all = patch.evaluate(cell, x, 2);
  Jet jet{0, Vector<2>::Zero(), Vector<3>::Zero()};
  for (int f = 0; f < patch.num_functions(); ++f) {
    const double value = c[patch.control_points()[f]];
    jet.value += value * all(f, 0);
    jet.gradient += value * all.row(f).segment<2>(1).transpose();
    jet.hessian += value * all.row(f).tail<3>().transpose();
  }
  return jet;
}

Eigen::VectorXd random_values(const PowellSabinBasis& basis, unsigned seed = 3) {
  return testing::Numbers(seed).columns<1>(basis.num_control_points()).transpose();
}

// Control values of f by its values and gradients at the vertices.
template <typename Value, typename Gradient>
Eigen::VectorXd interpolating(const PowellSabinBasis& basis, const Value& value,
                              const Gradient& gradient) {
  std::vector<double> values;
  std::vector<Vector<2>> gradients;
  for (const auto& v : basis.net().mesh.vertices) {
    values.push_back(value(v));
    gradients.push_back(gradient(v));
  }
  return basis.control_values(values, gradients);
}

class PowellSabin : public ::testing::TestWithParam<testing::NamedMesh> {
 protected:
  PowellSabinBasis basis{GetParam().mesh};
};
INSTANTIATE_TEST_SUITE_P(Meshes, PowellSabin, ::testing::ValuesIn(testing::powell_sabin_meshes()),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

}  // namespace

TEST_P(PowellSabin, FunctionsAreNotNegativeAndSumToOne) {
  for (const auto& x : points_of(basis)) {
    const auto b = basis.evaluate(x, 2);
    EXPECT_NEAR(b.values.sum(), 1.0, 1e-13);
    EXPECT_LT(b.gradients.rowwise().sum().norm(), 1e-11 * b.gradients.norm());
    EXPECT_LT(b.hessians.rowwise().sum().norm(), 1e-11 * b.hessians.norm());
    EXPECT_GT(b.values.minCoeff(), -1e-12);
    EXPECT_TRUE(std::ranges::is_sorted(b.control_points));
  }
}

TEST_P(PowellSabin, HasThreeFunctionsPerVertexThatLiveOnItsTriangles) {
  const auto& mesh = basis.net().mesh;
  EXPECT_EQ(basis.num_control_points(), 3 * std::ssize(mesh.vertices));
  for (int t = 0; t < static_cast<int>(mesh.simplices.size()); ++t) {
    for (int i : basis.patch(t).control_points()) {
      EXPECT_TRUE(std::ranges::find(mesh.simplices[t], i / 3) != mesh.simplices[t].end());
    }
  }
  EXPECT_EQ(basis.degree(), 2);
  EXPECT_EQ(basis.smoothness(), 1);
}

TEST_P(PowellSabin, IdentityIsReproducedByGrevillePoints) {
  const auto greville = basis.greville_points();
  for (const auto& x : points_of(basis)) {
    for (int a = 0; a < 2; ++a) {
      const Jet jet = spline(basis, greville.row(a).transpose(), x);
      EXPECT_NEAR(jet.value, x[a], 1e-12);
      EXPECT_LT((jet.gradient - Vector<2>::Unit(a)).norm(), 1e-10);
      EXPECT_LT(jet.hessian.norm(), 1e-8);
    }
  }
}

TEST_P(PowellSabin, ContainsAllQuadratics) {
  const auto value = [](const Point<2>& x) {
    return 3 - x[0] + 0.5 * x[1] + 0.25 * x[0] * x[0] - 0.7 * x[0] * x[1] + 0.4 * x[1] * x[1];
  };
  const auto gradient = [](const Point<2>& x) {
    return Vector<2>(-1 + 0.5 * x[0] - 0.7 * x[1], 0.5 - 0.7 * x[0] + 0.8 * x[1]);
  };
  const Eigen::VectorXd c = interpolating(basis, value, gradient);
  const double size = c.cwiseAbs().maxCoeff();
  for (const auto& x : points_of(basis)) {
    const Jet jet = spline(basis, c, x);
    EXPECT_NEAR(jet.value, value(x), 1e-12 * size);
    EXPECT_LT((jet.gradient - gradient(x)).norm(), 1e-10 * size);
    EXPECT_LT((jet.hessian - Vector<3>(0.5, -0.7, 0.8)).norm(), 1e-8 * size);
  }
  const auto fit =
      project<2>(basis, [&](const Point<2>& x) { return Vector<2>(value(x), -value(x)); });
  EXPECT_LT(fit.max_error, 1e-10 * size);
}

TEST_P(PowellSabin, TakesValuesAndGradientsAtVertices) {
  testing::Numbers numbers(8);
  std::map<std::pair<double, double>, double> values;
  std::map<std::pair<double, double>, Vector<2>> gradients;
  for (const auto& v : basis.net().mesh.vertices) {
    values[{v[0], v[1]}] = numbers();
    gradients[{v[0], v[1]}] = numbers.columns<2>(1);
  }
  const Eigen::VectorXd c = interpolating(
      basis,
      [&](const Point<2>& v) {
        return values.at({v[0], v[1]});
      },
      [&](const Point<2>& v) {
        return gradients.at({v[0], v[1]});
      });
  for (const auto& v : basis.net().mesh.vertices) {
    const Jet jet = spline(basis, c, v);
    EXPECT_NEAR(jet.value, values.at({v[0], v[1]}), 1e-12);
    EXPECT_LT((jet.gradient - gradients.at({v[0], v[1]})).norm(), 1e-10);
  }
}

// Value and gradient agree, second derivatives do not, across all edges of the small triangles, in a
// triangle of the mesh and between neighbours.
TEST_P(PowellSabin, IsSmoothAcrossAllEdges) {
  const Eigen::VectorXd c = random_values(basis);
  struct Side {
    int triangle, cell;
  };
  std::map<std::array<long long, 2>, std::vector<Side>> sides;  // by the edge's middle
  std::map<std::array<long long, 2>, std::array<Point<2>, 2>> edges;
  const double unit = 1e-9 * basis.bounds().diagonal();
  for (int t = 0; t < static_cast<int>(basis.net().mesh.simplices.size()); ++t) {
    for (int cell = 0; cell < PowellSabinPatch::kNumCells; ++cell) {
      const auto corners = basis.patch(t).cell(cell);
      for (int k = 0; k < 3; ++k) {
        const Point<2> middle = 0.5 * (corners[k] + corners[(k + 1) % 3]);
        const std::array key = {std::llround(middle.x() / unit), std::llround(middle.y() / unit)};
        sides[key].push_back({t, cell});
        edges[key] = {corners[k], corners[(k + 1) % 3]};
      }
    }
  }
  int between_triangles = 0;
  double jump = 0, gradient_jump = 0, hessian_jump = 0, gradient = 0;
  for (const auto& [key, of_edge] : sides) {
    if (of_edge.size() < 2) continue;
    ASSERT_EQ(of_edge.size(), 2);
    between_triangles += of_edge[0].triangle != of_edge[1].triangle;
    for (double s : {0.0, 0.13, 0.5, 0.9, 1.0}) {
      const Point<2> x = (1 - s) * edges[key][0] + s * edges[key][1];
      const Jet p = polynomial(basis, c, of_edge[0].triangle, of_edge[0].cell, x);
      const Jet q = polynomial(basis, c, of_edge[1].triangle, of_edge[1].cell, x);
      jump = std::max(jump, std::abs(p.value - q.value));
      gradient_jump = std::max(gradient_jump, (p.gradient - q.gradient).norm());
      hessian_jump = std::max(hessian_jump, (p.hessian - q.hessian).norm());
      gradient = std::max(gradient, p.gradient.norm());
    }
  }
  EXPECT_EQ(between_triangles > 0, basis.net().mesh.simplices.size() > 1);
  EXPECT_LT(jump, 1e-12);
  EXPECT_LT(gradient_jump, 1e-10 * gradient);
  EXPECT_GT(hessian_jump, 1e-2);
}

TEST_P(PowellSabin, DerivativesMatchCentralDifferences) {
  const Eigen::VectorXd c = random_values(basis);
  const auto& mesh = basis.net().mesh;
  for (int t = 0; t < static_cast<int>(mesh.simplices.size()); ++t) {
    const double step = 1e-5 * std::sqrt(signed_content<2>(simplex_corners(mesh, t)));
    const Point<2> x = simplex_centroid(mesh, t) + Vector<2>(0.3 * step, 0);
    for (int cell = 0; cell < PowellSabinPatch::kNumCells; ++cell) {
      const Jet jet = polynomial(basis, c, t, cell, x);
      for (int a = 0; a < 2; ++a) {
        const Vector<2> e = step * Vector<2>(Vector<2>::Unit(a));
        const Jet p = polynomial(basis, c, t, cell, x + e);
        const Jet q = polynomial(basis, c, t, cell, x - e);
        const double size = jet.hessian.norm() + 1;
        EXPECT_NEAR(jet.gradient[a], (p.value - q.value) / (2 * step), 1e-6 * size);
        const Vector<2> row = (p.gradient - q.gradient) / (2 * step);
        EXPECT_NEAR(jet.hessian[a == 0 ? 0 : 2], row[a], 1e-6 * size);
        EXPECT_NEAR(jet.hessian[1], row[1 - a], 1e-6 * size);
      }
    }
  }
}

TEST_P(PowellSabin, QuadratureIsExact) {
  const auto integrals = [&](int extra) {
    std::vector<Eigen::MatrixXd> sums(
        3, Eigen::MatrixXd::Zero(basis.num_control_points(), basis.num_control_points()));
    double area = 0;
    for (const auto& e : basis.quadrature(4 + extra, 2)) {
      area += e.weights.sum();
      const auto add = [&](Eigen::MatrixXd& sum, const Eigen::MatrixXd& f) {
        sum(e.control_points, e.control_points) += f * e.weights.asDiagonal() * f.transpose();
      };
      add(sums[0], e.values);
      for (const auto& g : e.gradients) add(sums[1], g);
      for (const auto& h : e.hessians) add(sums[2], h);
    }
    EXPECT_NEAR(area, basis.measure(), 1e-12 * area);
    return sums;
  };
  const auto few = integrals(0), many = integrals(4);
  for (int k = 0; k < 3; ++k) EXPECT_LT((few[k] - many[k]).norm(), 1e-12 * many[k].norm());
  // int B_i = int sum_k B_i B_k; the functions' matrix has full rank: they are a basis.
  EXPECT_NEAR(few[0].sum(), basis.measure(), 1e-12 * basis.measure());
  const Eigen::VectorXd scale = few[0].diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * few[0] * scale.asDiagonal();
  const Eigen::VectorXd spectrum =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
  EXPECT_GT(spectrum[0], 1e-4 * spectrum[spectrum.size() - 1]);
}

TEST_P(PowellSabin, AffineMapsAloneDoNotBend) {
  const Eigen::MatrixXd bending = BendingEnergy<2>(basis).matrix();
  const Eigen::VectorXd spectrum =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(bending, Eigen::EigenvaluesOnly).eigenvalues();
  const double largest = spectrum[spectrum.size() - 1];
  EXPECT_LT(std::abs(spectrum[2]), 1e-12 * largest);
  EXPECT_GT(spectrum[3], 1e-10 * largest);
}

TEST_P(PowellSabin, CouplesTheFunctionsThatMeet) {
  const auto pairs = basis.couplings();
  std::vector<std::pair<int, int>> expected;
  for (const auto& e : basis.quadrature(4, 0)) {
    for (int i : e.control_points) {
      for (int k : e.control_points) {
        if (i <= k) expected.emplace_back(i, k);
      }
    }
  }
  std::ranges::sort(expected);
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  EXPECT_EQ(pairs, expected);
}

TEST_P(PowellSabin, TrianglesOfVerticesAreSmall) {
  const auto& mesh = basis.net().mesh;
  const PowellSabinSplit split(mesh);
  const PowellSabinSides sides(mesh, split, {},
                               std::vector<Vector<2>>(mesh.vertices.size(), Vector<2>::Zero()));
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    std::vector<Point<2>> points;
    const auto to_hold = sides.points(mesh, split, v);
    for (const auto& p : to_hold.colwise()) points.emplace_back(p.head<2>());
    const auto& q = basis.net().vertices[v].corners;
    EXPECT_LT(0.5 * signed_content<2>({q.col(0).head<2>(), q.col(1).head<2>(), q.col(2).head<2>()}),
              2.01 * signed_area(convex_hull(points)));
  }
}

TEST(PowellSabinSplit, EdgePointsLieBetweenTheCentresOfBothTriangles) {
  for (const auto& [name, mesh] : testing::powell_sabin_meshes()) {
    const PowellSabinSplit split(mesh);
    const auto& edges = split.topology().edges();
    for (int e = 0; e < static_cast<int>(edges.size()); ++e) {
      const auto [a, b] = edges[e].vertices;
      EXPECT_GT(split.share(e, a), 0) << name;
      EXPECT_GT(split.share(e, b), 0) << name;
      EXPECT_NEAR(split.share(e, a) + split.share(e, b), 1, 1e-15);
      const Point<2> r =
          split.share(e, a) * mesh.vertices[a] + split.share(e, b) * mesh.vertices[b];
      EXPECT_LT((r - split.edge_point(e)).norm(), 1e-14);
      if (edges[e].triangles[1] < 0) continue;
      const Point<2>&p = split.centre(edges[e].triangles[0]),
            &q = split.centre(edges[e].triangles[1]);
      EXPECT_LT(std::abs(cross(q - p, r - p)), 1e-13 * (q - p).squaredNorm()) << name;
    }
  }
}

// The least area over all directions of the sides, by trying many.
TEST(EnclosingTriangle, IsNearlyTheSmallest) {
  std::vector<Polyline> polygons = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}},
                                    {{0, 0}, {3, 0}, {4, 1}, {1, 1}},
                                    testing::regular_polygon({3, 4}, 2, 5),
                                    testing::regular_polygon({0, 0}, 1, 6),
                                    {{0, 0}, {1, 0}, {0.2, 1e-3}}};
  testing::Numbers numbers(6);
  for (int trial = 0; trial < 5; ++trial) {
    std::vector<Point<2>> points;
    for (int k = 0; k < 9; ++k) points.emplace_back(numbers.columns<2>(1));
    polygons.push_back(convex_hull(points));
  }
  constexpr int kDirections = 90;
  for (const auto& polygon : polygons) {
    const auto triangle = enclosing_triangle(polygon);
    for (const auto& p : polygon) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_GT(signed_content<2>({p, triangle[k], triangle[(k + 1) % 3]}),
                  -1e-11 * signed_content<2>(triangle));
      }
    }
    std::vector<Vector<2>> normals;
    std::vector<double> reach;
    for (int d = 0; d < kDirections; ++d) {
      const double angle = 2 * std::numbers::pi * d / kDirections;
      normals.emplace_back(std::cos(angle), std::sin(angle));
      double most = -1e300;
      for (const auto& p : polygon) most = std::max(most, normals.back().dot(p));
      reach.push_back(most);
    }
    const auto meet = [&](int a, int b) {
      const double s = cross(normals[a], normals[b]);
      return Point<2>((reach[a] * normals[b].y() - reach[b] * normals[a].y()) / s,
                      (reach[b] * normals[a].x() - reach[a] * normals[b].x()) / s);
    };
    double least = 1e300;
    for (int a = 0; a < kDirections; ++a) {
      for (int b = a + 1; b < kDirections; ++b) {
        for (int c = b + 1; c < kDirections; ++c) {
          if (b - a >= kDirections / 2 || c - b >= kDirections / 2 ||
              kDirections - c + a >= kDirections / 2) {
            continue;
          }
          least = std::min(least, signed_content<2>({meet(a, b), meet(b, c), meet(c, a)}));
        }
      }
    }
    EXPECT_LT(signed_content<2>(triangle), 1.05 * least);
  }
  EXPECT_THROW(enclosing_triangle(Polyline{{0, 0}, {1, 0}, {2, 0}}), InvalidInput);
}

TEST(PowellSabinBasis, KnowsItsDomain) {
  const PowellSabinBasis basis(testing::concave_mesh());
  EXPECT_NEAR(basis.measure(), 8 * 3 + 5 * 3 - 1, 1e-10);
  EXPECT_LT((basis.bounds().upper - Point<2>(8, 8)).norm(), 1e-12);
  EXPECT_TRUE(basis.contains({0, 8}));
  EXPECT_TRUE(basis.contains({3, 3}));
  EXPECT_FALSE(basis.contains({1.5, 1.5}));
  EXPECT_FALSE(basis.contains({3.001, 3.001}));
  EXPECT_FALSE(basis.contains({std::nan(""), 1}));
  EXPECT_LT((basis.nearest_point({4, 7}) - Point<2>(3, 7)).norm(), 1e-12);
  EXPECT_LT((basis.nearest_point({7, 4}) - Point<2>(7, 3)).norm(), 1e-12);
  EXPECT_LT((basis.nearest_point({1.4, 1.1}) - Point<2>(1.4, 1)).norm(), 1e-12);
  EXPECT_TRUE(basis.contains(basis.nearest_point({-3, 44})));
  EXPECT_THAT(
      [&] {
        basis.evaluate({5, 5});
      },
      ThrowsMessage<InvalidInput>(HasSubstr("outside the domain")));
}

TEST(PowellSabinBasis, CarriesRegionsToItsElements) {
  const auto net = testing::ring_net(2, 0.3, true);
  const PowellSabinBasis basis(net.mesh);
  double body = 0;
  for (const auto& e : basis.quadrature(0, 0)) {
    EXPECT_EQ(e.region, net.mesh.region(e.patch));
    if (e.region == 1) body += e.weights.sum();
  }
  EXPECT_NEAR(body, testing::region_area(net.mesh, 1), 1e-12);
  const auto wanted = basis.quadrature(0, 0, [](int region, int) { return region == 1; });
  for (const auto& e : wanted) EXPECT_EQ(e.region, 1);
  EXPECT_EQ(std::ssize(wanted), std::ranges::count(net.mesh.regions, 1));
}

TEST(PowellSabinBasis, IsAffinelyInvariantOnceItsTrianglesAreGiven) {
  // Not the split: incentres of a sheared triangle are other points. Shifts, turns and scales keep it.
  const auto mesh = testing::jittered_mesh(3, 3, 4);
  const Matrix<2> turn = 1.7 * testing::turned<2>(0.4);
  const Point<2> shift(-120, 310);
  const auto moved = [&](const Point<2>& p) { return Point<2>(turn * p + shift); };
  PowellSabinNet net = place_powell_sabin(mesh);
  const PowellSabinBasis basis(net);
  for (auto& v : net.mesh.vertices) v = moved(v);
  for (auto& vertex : net.vertices) {
    for (auto q : vertex.corners.colwise()) q.head<2>() = moved(q.head<2>());
  }
  const PowellSabinBasis other(net);
  for (const auto& x : testing::points_inside(mesh, 4, 2)) {
    const auto b = basis.evaluate(x), d = other.evaluate(moved(x));
    EXPECT_EQ(b.control_points, d.control_points);
    EXPECT_LT((b.values - d.values).norm(), 1e-12);
  }
}

TEST(PowellSabinBasis, RefusesMeshesAndTrianglesThatCannotWork) {
  const PowellSabinNet good = place_powell_sabin(testing::jittered_mesh(3, 3, 1));
  const auto expect_refusal = [&](const char* words, auto change) {
    auto net = good;
    change(net);
    EXPECT_THAT([&] { PowellSabinBasis{net}; }, ThrowsMessage<InvalidInput>(HasSubstr(words)));
  };
  expect_refusal("no triangle", [](auto& net) { net.mesh.simplices.clear(); });
  expect_refusal("triangle 3 (vertices",
                 [](auto& net) { std::swap(net.mesh.simplices[3][0], net.mesh.simplices[3][1]); });
  expect_refusal("folded or flat", [](auto& net) {
    const auto& s = net.mesh.simplices[0];
    net.mesh.vertices[s[2]] = 0.5 * (net.mesh.vertices[s[0]] + net.mesh.vertices[s[1]]);
  });
  expect_refusal("same side of their edge between vertices 0 and 1", [](auto& net) {
    net.mesh = {{{0, 0}, {4, 0}, {1, 3}, {3, 3}}, {{0, 1, 2}, {0, 1, 3}}, {}};
    net.vertices.resize(4);
  });
  expect_refusal("more than two triangles", [](auto& net) {
    net.mesh.simplices.push_back(net.mesh.simplices[7]);
    net.mesh.simplices.push_back(net.mesh.simplices[7]);
  });
  expect_refusal("names vertex 77", [](auto& net) { net.mesh.simplices[2][1] = 77; });
  expect_refusal("vertex 16 belongs to no triangle",
                 [](auto& net) { net.mesh.vertices.emplace_back(5, 5); });
  expect_refusal("vertex 5 is not a finite point",
                 [](auto& net) { net.mesh.vertices[5][0] = std::nan(""); });
  expect_refusal("2 regions for 18 triangles", [](auto& net) { net.mesh.regions = {0, 1}; });
  expect_refusal("15 triangles for 16 vertices", [](auto& net) { net.vertices.pop_back(); });
  expect_refusal("triangle of vertex 6 is folded", [](auto& net) {
    net.vertices[6].corners.col(0).swap(net.vertices[6].corners.col(1));
  });
  expect_refusal("triangle of vertex 6 is folded, flat or not finite",
                 [](auto& net) { net.vertices[6].corners(1, 0) = std::nan(""); });
  expect_refusal("triangle of vertex 9 does not hold", [](auto& net) {
    auto corners = net.vertices[9].corners.template topRows<2>();
    corners = (0.8 * corners).colwise() + 0.2 * net.mesh.vertices[9];
  });
  expect_refusal("vertex 9 has the wrong number of corners",
                 [](auto& net) { net.vertices[9].corners.setZero(3, 4); });
  expect_refusal("crease edge 0, 1 is no edge inside", [](auto& net) {
    net.crease_edges.push_back({{0, 1}, false});
  });
  expect_refusal("vertex 9 do not divide",
                 [](auto& net) { net.vertices[9].normal = Vector<2>(1, 0); });
  EXPECT_THROW(PowellSabinBasis(good).control_values({}, {}), InvalidInput);
}

}  // namespace crease

// Load steps against solutions that are known otherwise.
#include <gtest/gtest.h>

#include "Registration/Elastic/LoadSteps.h"
#include "Testing/LagrangeElasticity.h"
#include "Testing/Registration/Elastic/ElasticBodies.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/Energies/StoredEnergy.h"
#include "Transforms/Splines/PowellSabinBasis.h"

namespace crease {
namespace {

using testing::along;

/// Points along the border of the rectangle [0, width] x [0, height].
std::vector<Point<2>> round_border(double width, double height, int count) {
  std::vector<Point<2>> points;
  const std::vector<Point<2>> corners = {{0, 0}, {width, 0}, {width, height}, {0, height}};
  for (int k = 0; k < 4; ++k) {
    const auto side = along(corners[k], corners[(k + 1) % 4], count);
    points.insert(points.end(), side.begin(), side.end());
  }
  return points;
}

DomainMesh wavy_rectangle() {
  Polyline wave;
  for (int k = 0; k <= 20; ++k) wave.emplace_back(0.3 * k, 2 + 0.3 * std::sin(0.9 * k));
  return mesh_domain(testing::rectangle(0, 0, 6, 4), {testing::open_line(wave)},
                     {.edge_length = 1.3});
}

/// A bar of three parts, stiffness 1, 2, 1, each of length 1, in 2 x 2 cells each; lines at the joints.
DomainMesh three_springs() {
  SimplexMesh<2> mesh = structured_triangulation(testing::box(0, 0, 3, 1), 6, 2);
  mesh.regions.resize(mesh.simplices.size());
  for (std::size_t t = 0; t < mesh.simplices.size(); ++t) {
    const auto& s = mesh.simplices[t];
    const double x =
        (mesh.vertices[s[0]].x() + mesh.vertices[s[1]].x() + mesh.vertices[s[2]].x()) / 3;
    mesh.regions[t] = x > 1 && x < 2 ? 1 : 0;
  }
  const std::vector<int> regions = mesh.regions;
  DomainMesh domain =
      attach_feature_lines(std::move(mesh), {testing::open_line({{1, 0}, {1, 0.5}, {1, 1}}),
                                             testing::open_line({{2, 0}, {2, 0.5}, {2, 1}})});
  domain.mesh.regions = regions;
  return domain;
}

/// Stretches s and t of the soft and the stiff parts: 2 s + t = length, s (s^2 - 1) = 2 t (t^2 - 1).
std::pair<double, double> spring_stretches(double length) {
  const auto stress = [](double s) { return 0.5 * s * (s * s - 1); };
  double low = 1, high = length / 2;
  for (int n = 0; n < 200; ++n) {
    const double s = 0.5 * (low + high);
    (stress(s) < 2 * stress(length - 2 * s) ? low : high) = s;
  }
  return {low, length - 2 * low};
}

/// Largest error of the three springs' displacement at points of a grid.
double spring_error(const KnotOptions& options) {
  const auto basis = testing::spline_on(three_springs(), options);
  const auto [s, t] = spring_stretches(3.6);
  const auto exact = [s = s, t = t](const Point<2>& p) {
    const double x = p.x() < 1   ? s * p.x()
                     : p.x() < 2 ? s + t * (p.x() - 1)
                                 : s + t + s * (p.x() - 2);
    return Vector<2>(x - p.x(), 0);
  };
  ElasticMaterial material;
  material.tissue = {.young = 1, .poisson = 0};
  material.regions[1] = {.young = 2, .poisson = 0};
  std::vector<Point<2>> ends = along({0, 0}, {0, 1}, 40);
  const auto right = along({3, 0}, {3, 1}, 40);
  ends.insert(ends.end(), right.begin(), right.end());
  ControlPoints<2> values = basis->greville_points();
  for (auto column : values.colwise()) {
    // Functions at an end see the straight part of that end alone.
    const double x = column.x();
    column = Vector<2>(x < 1.5 ? (s - 1) * x : 0.6 + (s - 1) * (x - 3), 0);
  }
  const auto constraints = testing::held_control_points(*basis, ends, values);
  const auto result =
      run_load_steps(ElasticEnergy<2>(*basis, material), *basis, constraints, {.steps = 4});
  SplineTransform<2> transform(basis);
  transform.set_control_points(result.control_points);
  double error = 0;
  for (int i = 0; i <= 60; ++i) {
    for (int j = 0; j <= 10; ++j) {
      const Point<2> p(0.05 * i, 0.1 * j);
      error = std::max(error, (transform.map(p) - p - exact(p)).norm());
    }
  }
  return error;
}

/// Cook's membrane, linear, sheared by a unit force: height won by its upper right corner.
double cook_tip(int cells, const ElasticTissue& tissue, PlaneState plane, bool collapsed,
                bool mean_dilatation = false, int degree = 2) {
  SimplexMesh<2> mesh = structured_triangulation(testing::box(0, 0, 1, 1), cells, cells);
  for (auto& v : mesh.vertices) {
    const double low = 44 * v.x(), high = 44 + 16 * v.x();
    v = Point<2>(48 * v.x(), low + (high - low) * v.y());
  }
  DomainMesh domain;
  domain.mesh = mesh;
  const auto basis = testing::spline_on(
      domain,
      {.degree = degree, .border = BorderRule::kOnStraightBorder, .collapse_all = collapsed});
  ElasticMaterial material;
  material.tissue = tissue;
  material.plane = plane;
  material.mean_dilatation = mean_dilatation;
  const ElasticEnergy<2> energy(*basis, material);
  BlockHessian<2> hessian(energy.pattern());
  const ControlPoints<2> rest = ControlPoints<2>::Zero(2, basis->num_control_points());
  energy.evaluate(rest, 1, nullptr, &hessian, ElasticTangent::kExact, nullptr);
  ControlPoints<2> load = rest;
  const int count = 64 * cells;
  for (int k = 0; k < count; ++k) {
    const Point<2> p(48, 44 + 16 * (k + 0.5) / count);
    const auto values = basis->evaluate(basis->contains(p) ? p : basis->nearest_point(p));
    for (std::size_t i = 0; i < values.control_points.size(); ++i) {
      load(1, values.control_points[i]) += values.values[i] / count;
    }
  }
  const auto clamped =
      testing::held_control_points(*basis, along({0, 0}, {0, 44}, 8 * cells), rest);
  const auto null_space =
      make_null_space(NullSpaceKind::kElimination, clamped, basis->num_control_points());
  Eigen::SparseMatrix<double> reduced;
  null_space->reduce_hessian(hessian.to_sparse(), reduced);
  SparseCholesky factor;
  EXPECT_TRUE(factor.factor(reduced));
  const Eigen::VectorXd u =
      null_space->apply(factor.solve(null_space->apply_transpose(load.reshaped())));
  SplineTransform<2> transform(basis);
  transform.set_control_points(u.reshaped(2, basis->num_control_points()));
  const Point<2> tip = basis->nearest_point({48, 60});
  return (transform.map(tip) - tip).y();
}

}  // namespace

// An affine motion of the border is one of the whole body, with the same stress everywhere.
TEST(LoadStepsExact, PassThePatchTest) {
  AffineMap<2> map;
  map.linear << 1.15, 0.2, -0.1, 0.9;
  map.offset << 1, -2;
  const DomainMesh domain = wavy_rectangle();
  for (const KnotOptions& options :
       {KnotOptions{.degree = 2}, KnotOptions{.degree = 2, .creases = false},
        KnotOptions{.degree = 2, .collapse_all = true}, KnotOptions{.degree = 3, .smoothness = 1},
        KnotOptions{.degree = 1}}) {
    const auto basis = testing::spline_on(domain, options);
    const auto exact = testing::affine_control_points<2>(*basis, map);
    ElasticMaterial material;
    material.tissue.poisson = 0.4;
    const auto result = run_load_steps(
        ElasticEnergy<2>(*basis, material), *basis,
        testing::held_control_points(*basis, round_border(6, 4, 120), exact), {.steps = 3});
    EXPECT_LT((result.control_points - exact).cwiseAbs().maxCoeff(), 1e-10)
        << "degree " << options.degree;
    SplineTransform<2> transform(basis);
    transform.set_control_points(result.control_points);
    const auto stress = elastic_state<2>(material, 0, map.linear).cauchy_stress;
    for (const Point<2>& p : {Point<2>(1.1, 1.2), Point<2>(3.3, 2.2), Point<2>(5.2, 3.4)}) {
      const auto state = elastic_state<2>(material, 0, transform.spatial_jacobian(p));
      EXPECT_LT((state.cauchy_stress - stress).norm(), 1e-10);
    }
  }
}

TEST(LoadStepsExact, CollapsedKnotsAreLagrangeElements) {
  const DomainMesh domain = testing::half_ellipse(16);
  ElasticDeformation deformation;
  deformation.basis = testing::spline_on(domain, {.degree = 2, .collapse_all = true});
  // One cell per triangle.
  EXPECT_EQ(deformation.basis->quadrature(4, 1).size(), domain.mesh.simplices.size());
  deformation.material.tissue = {.young = 1, .poisson = 0.45};
  deformation.material.regions[1] = {.young = 10, .poisson = 0.45};
  testing::LagrangeBody body(domain.mesh, [&](int region) {
    return lame_parameters(deformation.material.of(region), PlaneState::kStress);
  });
  std::map<int, Vector<2>> prescribed;
  for (std::size_t n = 0; n < body.nodes().size(); n += 9) {
    const Point<2>& p = body.nodes()[n];
    prescribed[static_cast<int>(n)] = testing::smooth_motion(p);
    deformation.pairs.fixed.push_back(p);
    deformation.pairs.moving.emplace_back(p + testing::smooth_motion(p));
  }
  ASSERT_GT(prescribed.size(), 10U);
  body.solve(prescribed, 5);
  const auto result = deform_elastically(deformation, {.steps = 5, .tolerance = 1e-11});
  const auto transform = transform_of(deformation, result);
  testing::Numbers numbers(3);
  for (int n = 0; n < 200; ++n) {
    const Point<2> x(25 + 22 * numbers(), 30 * numbers());
    const Vector<2> expected = body.displacement(x);
    EXPECT_LT((transform.map(x) - x - expected).norm(), 1e-9) << x.transpose();
  }
}

TEST(LoadStepsExact, ThreeSpringsKinkAtTheirJoints) {
  EXPECT_LT(spring_error({.degree = 2}), 1e-10);
  EXPECT_LT(spring_error({.degree = 2, .collapse_all = true}), 1e-10);
  EXPECT_GT(spring_error({.degree = 2, .creases = false}), 1e-3);
}

TEST(LoadStepsExact, CooksMembrane) {
  const ElasticTissue nearly_incompressible{.young = 1, .poisson = 0.495};
  const ElasticTissue compressible{.young = 1, .poisson = 0.3};
  for (const bool collapsed : {false, true}) {
    EXPECT_NEAR(cook_tip(32, nearly_incompressible, PlaneState::kStrain, collapsed), 19.56,
                0.006 * 19.56);
    EXPECT_NEAR(cook_tip(32, compressible, PlaneState::kStrain, collapsed), 23.04, 0.006 * 23.04);
  }
  // Linear elements lock; a mean dilatation frees quadratic ones already on coarse meshes.
  EXPECT_LT(cook_tip(8, nearly_incompressible, PlaneState::kStrain, true, false, 1), 17);
  EXPECT_GT(cook_tip(4, nearly_incompressible, PlaneState::kStrain, true, true),
            cook_tip(4, nearly_incompressible, PlaneState::kStrain, true, false));
}

}  // namespace crease

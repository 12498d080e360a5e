#include "Transforms/Splines/TSplineBasis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Testing/Transforms/SampleNurbs.h"
#include "Transforms/Energies/ScalarAssembly.h"
#include "Transforms/SplineProjection.h"
#include "Transforms/Splines/TSplineMerge.h"
#include "Transforms/Splines/TSplineSimplification.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::Numbers;
using ::testing::ThrowsMessage;

TSplineBasis box_tspline(int degree, double size = 8, int spans = 8) {
  const KnotVector knots = KnotVector::even(degree, 0, size, spans);
  return TSplineBasis(TMesh::tensor(knots, knots));
}

std::vector<int> elements_near(const TSplineBasis& basis, const Vector<2>& place, double radius) {
  std::vector<int> near;
  for (int e = 0; e < std::ssize(basis.elements()); ++e) {
    const auto& element = basis.elements()[e];
    if ((0.5 * (element.lower + element.upper) - place).norm() < radius) near.push_back(e);
  }
  return near;
}

/// Refined twice about one place, which leaves many T-junctions.
TSplineRefinement twice_refined(const TSplineBasis& basis, const Eigen::MatrixXd& phi) {
  const auto once = refined(basis, phi, elements_near(basis, {3, 4}, 2.0));
  return refined(*once.basis, once.control_points, elements_near(*once.basis, {4.5, 4}, 1.2));
}

/// Largest distance of two maps on a part of the plane.
double difference(const TSplineBasis& a, const Eigen::MatrixXd& of_a, const TSplineBasis& b,
                  const Eigen::MatrixXd& of_b, const Vector<2>& lower, const Vector<2>& upper) {
  Numbers numbers(4);
  double largest = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vector<2> share = 0.5 + 0.5 * numbers.columns<2>(1).array();
    const Point<2> x = lower + share.cwiseProduct(upper - lower);
    const auto left = a.evaluate(x), right = b.evaluate(x);
    const Eigen::VectorXd u = of_a(Eigen::all, left.control_points) * left.values;
    const Eigen::VectorXd v = of_b(Eigen::all, right.control_points) * right.values;
    largest = std::max(largest, (u - v).norm());
  }
  return largest;
}

}  // namespace

class TSplines : public ::testing::TestWithParam<int> {
 public:
  TSplineBasis coarse = box_tspline(GetParam());
  Eigen::MatrixXd phi = Numbers(1).columns<3>(coarse.num_control_points());
  TSplineRefinement fine = twice_refined(coarse, phi);
};

INSTANTIATE_TEST_SUITE_P(Degrees, TSplines, ::testing::Values(1, 3, 5));

TEST_P(TSplines, LocalRefinementIsExactAndLocal) {
  EXPECT_LT(difference(coarse, phi, *fine.basis, fine.control_points, {0, 0}, {8, 8}), 1e-14);
  const int all = box_tspline(GetParam(), 8, 32).num_control_points();
  EXPECT_LT(fine.basis->num_control_points(), all / 2);
  EXPECT_GT(fine.basis->num_control_points(), coarse.num_control_points() + 50);
  EXPECT_TRUE(fine.basis->mesh().is_analysis_suitable());
  EXPECT_GT(fine.basis->mesh().junctions().size(), 20u);
  // The identity and the sum stay what they are.
  const auto identity = twice_refined(coarse, coarse.greville_points());
  EXPECT_LT((identity.control_points - identity.basis->greville_points()).norm(), 1e-12);
}

TEST_P(TSplines, HoldAsManyFunctionsPerElementAsTensorMeshes) {
  const std::size_t expected = (GetParam() + 1) * (GetParam() + 1);
  for (const auto& element : fine.basis->elements()) {
    EXPECT_EQ(element.functions.size(), expected);  // so that they are independent on each
  }
}

TEST_P(TSplines, FunctionsAreIndependent) {
  const Eigen::MatrixXd mass = mass_matrix<2>(*fine.basis);
  const Eigen::VectorXd scale = mass.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scale.asDiagonal() * mass *
                                                              scale.asDiagonal());
  EXPECT_GT(solver.eigenvalues()[0], 1e-6);
}

// Polynomials of the degree in each variable are in the space.
TEST_P(TSplines, ReproducePolynomials) {
  const int n = GetParam();
  const auto f = [&](const Point<2>& x) -> Vector<2> {
    const Vector<2> t = x / 4 - Vector<2>::Ones();
    return {std::pow(t[0], n) * std::pow(t[1], n), std::pow(t[0], n) - std::pow(t[1], n) + t[0]};
  };
  EXPECT_LT(project<2>(*fine.basis, f).max_error, 1e-12);
}

// Every function is one polynomial on each element: the rule of the exact degree is as good as any.
TEST_P(TSplines, QuadratureIsExact) {
  const auto& basis = *fine.basis;
  const auto mass = mass_matrix<2>(basis);
  const auto finer = assemble_scalar_matrix<2>(
      basis, 2 * GetParam() + 6, 0, [](const QuadratureElement<2>& e, Eigen::MatrixXd& factor) {
        factor = e.values * e.weights.cwiseSqrt().asDiagonal();
      });
  EXPECT_LT((mass - finer).norm(), 1e-13 * mass.norm());
  EXPECT_NEAR(mass.sum(), 64, 1e-11);
}

TEST_P(TSplines, AreAsSmoothAsTheirDegreeAcrossAllLines) {
  const auto& basis = *fine.basis;
  EXPECT_EQ(basis.smoothness(), GetParam() - 1);
  if (GetParam() == 1) return;
  for (double line : {2.0, 3.25, 3.5, 4.5}) {
    for (double v : {0.3, 3.1, 3.9, 7.7}) {
      const auto a = basis.evaluate({line - 1e-9, v}, 2), b = basis.evaluate({line + 1e-9, v}, 2);
      const Eigen::MatrixXd jump =
          fine.control_points(Eigen::all, a.control_points) * a.hessians.transpose() -
          fine.control_points(Eigen::all, b.control_points) * b.hessians.transpose();
      EXPECT_LT(jump.norm(), 1e-5);
    }
  }
}

TEST_P(TSplines, SimplificationUndoesRefinement) {
  const auto once = refined(coarse, phi, elements_near(coarse, {3, 4}, 2.0));
  for (const auto& refinement : {once, fine}) {
    const auto simple = simplified(*refinement.basis, refinement.control_points, 1e-10);
    EXPECT_EQ(simple.basis->num_control_points(), coarse.num_control_points());
    EXPECT_EQ(simple.basis->mesh(), coarse.mesh());
    EXPECT_LT(simple.max_error, 1e-13);
    EXPECT_LT((simple.control_points - phi).norm(), 1e-12);
  }
}

// A detail in one corner: the rest needs no fine mesh. The bound holds.
TEST_P(TSplines, SimplificationKeepsWhatTheMapNeeds) {
  const auto fine_grid = box_tspline(GetParam(), 8, 16);
  Eigen::MatrixXd points = fine_grid.greville_points();
  for (int i = 0; i < points.cols(); ++i) {
    const double distance = (points.col(i) - Vector<2>(2, 2)).norm();
    points(0, i) += std::exp(-distance * distance);
  }
  for (double tolerance : {1e-2, 1e-3}) {
    const auto simple = simplified(fine_grid, points, tolerance);
    EXPECT_LT(simple.basis->num_control_points(), 0.8 * fine_grid.num_control_points());
    EXPECT_LE(simple.max_error, tolerance);
    EXPECT_LE(difference(fine_grid, points, *simple.basis, simple.control_points, {0, 0}, {8, 8}),
              simple.max_error);
  }
}

// Two patches with other knots, whose maps agree along the common edge.
class MergedTSplines : public ::testing::TestWithParam<int> {
 public:
  MergedTSplines() {
    const int n = GetParam();
    const KnotVector u = KnotVector::even(n, 0, 4, 4), more_u = KnotVector::even(n, 4, 10, 7);
    first = std::make_shared<TSplineBasis>(TMesh::tensor(u, KnotVector::even(n, 0, 6, 5)));
    second = std::make_shared<TSplineBasis>(TMesh::tensor(more_u, KnotVector::even(n, 0, 6, 7)));
    of_first = moved(*first);
    of_second = moved(*second);
  }
  static Eigen::MatrixXd moved(const TSplineBasis& basis) {
    Eigen::MatrixXd points = basis.greville_points();
    Numbers numbers(9);
    for (int i = 0; i < points.cols(); ++i) {
      const Vector<2> shift = numbers.columns<2>(1, 0.3);
      if (std::abs(points(0, i) - 4) > 1e-9) points.col(i) += shift;
    }
    return points;
  }
  std::shared_ptr<const TSplineBasis> first, second;
  Eigen::MatrixXd of_first, of_second;
};

INSTANTIATE_TEST_SUITE_P(Degrees, MergedTSplines, ::testing::Values(1, 3, 5));

TEST_P(MergedTSplines, AreBothPatchesWhereTheseMeet) {
  const auto one = merged(*first, of_first, *second, of_second, 0, 0);
  EXPECT_LT(one.max_error, 1e-13);
  EXPECT_EQ(one.basis->smoothness(), 0);
  EXPECT_LT(difference(*first, of_first, *one.basis, one.control_points, {0, 0}, {4 - 1e-9, 6}),
            1e-13);
  EXPECT_LT(difference(*second, of_second, *one.basis, one.control_points, {4, 0}, {10, 6}), 1e-13);
  EXPECT_EQ(one.basis->measure(), 60);
}

TEST_P(MergedTSplines, JoinSmoothlyAndLocally) {
  const int n = GetParam();
  for (int smoothness = 1; smoothness < n; ++smoothness) {
    const auto one = merged(*first, of_first, *second, of_second, 0, smoothness);
    EXPECT_EQ(one.basis->smoothness(), smoothness);
    EXPECT_GT(one.max_error, 1e-3);  // the patches have a kink
    EXPECT_LT(one.max_error, 0.5);
    EXPECT_LE(difference(*first, of_first, *one.basis, one.control_points, {0, 0}, {4 - 1e-9, 6}),
              one.max_error);
    EXPECT_LT(difference(*second, of_second, *one.basis, one.control_points, {9.2, 0}, {10, 6}),
              1e-2);
    const auto slope = [&](double u) {
      const auto b = one.basis->evaluate({u, 2.3}, 1);
      return Vector<2>(one.control_points(Eigen::all, b.control_points) *
                       b.gradients.row(0).transpose());
    };
    EXPECT_LT((slope(4 + 1e-9) - slope(4 - 1e-9)).norm(), 1e-6);
  }
}

// One smooth map cut in two is found again, whole.
TEST_P(MergedTSplines, MergeTheHalvesOfASmoothMap) {
  const int n = GetParam();
  const auto map = [&](const Point<2>& x) -> Vector<2> {
    return {std::pow(x[0] / 5, n), std::pow(x[1] / 5, n) * x[0]};
  };
  const auto a = project<2>(*first, map), b = project<2>(*second, map);
  const auto one = merged(*first, a.control_points, *second, b.control_points, 0, n - 1);
  EXPECT_LT(one.max_error, 1e-11);
}

TEST(TSplineMerge, WorksAlongTheOtherAxisAndRefusesStrangers) {
  const KnotVector u = KnotVector::even(3, 0, 4, 4), v = KnotVector::even(3, 0, 2, 3);
  const TSplineBasis below(TMesh::tensor(u, v));
  const TSplineBasis above(
      TMesh::tensor(KnotVector::even(3, 0, 4, 6), KnotVector::even(3, 2, 5, 4)));
  const auto one = merged(below, below.greville_points(), above, above.greville_points(), 1, 2);
  EXPECT_LT(one.max_error, 1e-13);
  EXPECT_LT((one.control_points - one.basis->greville_points()).norm(), 1e-11);
  EXPECT_THAT([&] { merged(below, below.greville_points(), above, above.greville_points(), 0, 2); },
              ThrowsMessage<InvalidInput>(HasSubstr("do not share an edge across axis 0")));
  EXPECT_THROW(merged(below, below.greville_points(), above, below.greville_points(), 1, 2),
               InvalidInput);
  EXPECT_THROW(merged(below, below.greville_points(), above, above.greville_points(), 1, 3),
               InvalidInput);
}

TEST(TSplineRefinement, RefinesAroundControlPoints) {
  const auto basis = box_tspline(3);
  const Eigen::MatrixXd phi = Numbers().columns<2>(basis.num_control_points());
  const auto fine = refined_around(basis, phi, {60});
  EXPECT_LT(difference(basis, phi, *fine.basis, fine.control_points, {0, 0}, {8, 8}), 1e-14);
  // The 4 x 4 elements of the function's support are halved, not others far away.
  const auto& element = fine.basis->elements()[fine.basis->find_element({4.1, 4.1})];
  EXPECT_NEAR(element.upper[0] - element.lower[0], 0.5, 1e-15);
  const auto& far = fine.basis->elements()[fine.basis->find_element({0.1, 0.1})];
  EXPECT_NEAR(far.upper[0] - far.lower[0], 1, 1e-15);
}

TEST(TSplineRefinement, AddsSingleEdges) {
  const auto basis = box_tspline(3);
  const Eigen::MatrixXd phi = Numbers().columns<2>(basis.num_control_points());
  const auto fine = with_edges(basis, phi, {{0, 2.3, 2.5, 4.5}});  // led on to 2 and 5
  EXPECT_LT(difference(basis, phi, *fine.basis, fine.control_points, {0, 0}, {8, 8}), 1e-14);
  EXPECT_EQ(fine.basis->num_control_points(), basis.num_control_points() + 4);
}

TEST(TSplineRefinement, CoversARasterFinerWhereAsked) {
  Raster<2> raster;
  raster.size = {120, 80};
  raster.spacing = {0.5, 1.0};
  raster.origin = {7, -3};
  raster.direction = testing::turned<2>();
  const Point<2> place = raster.point({30, 50});
  const auto field = [&](const Point<2>& x) { return std::max(1.5, (x - place).norm()); };
  for (int degree : {1, 3}) {
    const auto coarse = covering_tspline(raster, 12, nullptr, degree);
    const auto basis = covering_tspline(raster, 12, field, degree);
    EXPECT_LT((basis->bounds().lower - raster.bounds().lower).norm(), 1e-12);
    EXPECT_LT((basis->bounds().upper - raster.bounds().upper).norm(), 1e-12);
    EXPECT_EQ(coarse->elements().size(), 5u * 7u);
    EXPECT_GT(basis->num_control_points(), 2 * coarse->num_control_points());
    EXPECT_LT(basis->mean_edge_length(), coarse->mean_edge_length());
    for (int j = 0; j < 80; ++j) {
      for (int i = 0; i < 120; ++i) {
        const Point<2> x = raster.point({double(i), double(j)});
        const auto& e = basis->elements()[basis->find_element(basis->box().coordinates(x))];
        ASSERT_LE((e.upper - e.lower).maxCoeff(), 1.42 * std::max(field(x), 12 / 1.42 + 1));
        if (field(x) < 2) ASSERT_LE((e.upper - e.lower).maxCoeff(), 1.42 * field(x));
      }
    }
  }
  EXPECT_THAT([&] { covering_tspline(raster, 12, [](const Point<2>&) { return 0.0; }); },
              ThrowsMessage<InvalidInput>(HasSubstr("must be positive")));
  EXPECT_THROW(covering_tspline(raster, -1), InvalidInput);
  EXPECT_THROW(covering_tspline(raster, 12, nullptr, 2), InvalidInput);
  EXPECT_THROW(covering_tspline(Raster<2>(), 12), InvalidInput);
}

TEST(TSplineBasis, HasTheFunctionsOfItsTensorMesh) {
  const auto net = testing::nurbs_net(testing::small_lattice<2>(), 3);
  const NurbsBasis<2> nurbs(net);
  const TSplineBasis tspline(TMesh::tensor(nurbs.axes()[0], nurbs.axes()[1]), net.origin,
                             net.direction);
  EXPECT_EQ(tspline.smoothness(), nurbs.smoothness());
  for (const auto& x : testing::points_inside<2>(testing::small_lattice<2>(), 40, 0.0)) {
    const auto a = tspline.evaluate(x, 2), b = nurbs.evaluate(x, 2);
    EXPECT_EQ(a.control_points, b.control_points);
    EXPECT_LT((a.values - b.values).norm(), 1e-14);
    EXPECT_LT((a.gradients - b.gradients).norm(), 1e-13);
    EXPECT_LT((a.hessians - b.hessians).norm(), 1e-12);
  }
}

TEST(TSplineBasis, RefinesTheSameOnAnyNumberOfThreads) {
  const auto basis = box_tspline(3);
  const Eigen::MatrixXd phi = Numbers().columns<2>(basis.num_control_points());
  set_num_threads(1);
  const auto one = twice_refined(basis, phi);
  set_num_threads(4);
  const auto four = twice_refined(basis, phi);
  set_num_threads(0);
  EXPECT_EQ(one.control_points, four.control_points);
  EXPECT_EQ(one.basis->mesh(), four.basis->mesh());
}

TEST(TSplineBasis, NamesWhatIsWrong) {
  const auto basis = box_tspline(3);
  const Eigen::MatrixXd phi = Eigen::MatrixXd::Zero(2, basis.num_control_points());
  EXPECT_THROW(basis.evaluate({9, 0}), InvalidInput);
  EXPECT_THROW(basis.evaluate({std::nan(""), 0}), InvalidInput);
  EXPECT_THROW(refined(basis, phi.leftCols(3), {0}), InvalidInput);
  EXPECT_THAT([&] { refined(basis, phi, {64}); },
              ThrowsMessage<InvalidInput>(HasSubstr("no Bezier element 64")));
  EXPECT_THROW(refined_around(basis, phi, {-1}), InvalidInput);
  EXPECT_THROW(with_edges(basis, phi, {{0, 9, 1, 2}}), InvalidInput);
  EXPECT_THROW(simplified(basis, phi, 0), InvalidInput);
  EXPECT_THROW(TSplineBasis(basis.mesh(), {0, 0}, 2 * Matrix<2>::Identity()), InvalidInput);
  const auto torn = [] {
    std::vector<double> lines = {0, 0, 1, 1, 1, 1, 2, 2};
    std::vector<TSegment> segments;
    for (int axis : {0, 1}) {
      for (int line = 0; line < 8; ++line) segments.push_back({axis, line, 0, 7});
    }
    return TMesh(3, {lines, lines}, segments);
  };
  EXPECT_THAT([&] { TSplineBasis{torn()}; },
              ThrowsMessage<InvalidInput>(HasSubstr("the map would tear")));
}

}  // namespace crease

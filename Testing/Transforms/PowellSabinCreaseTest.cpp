// Creases of Powell-Sabin splines, along lines of every kind.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <map>

#include "Testing/Transforms/CreasedDomains.h"
#include "Testing/Transforms/SampleSplines.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/SplineProjection.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/PowellSabinCreases.h"

namespace crease {
namespace {

using Values = Eigen::VectorXd;

// Value and gradient of sum_i c_i B_i by the polynomials of one small triangle.
Vector<3> jet(const PowellSabinBasis& basis, const Values& c, int triangle, int cell,
              const Point<2>& x) {
  const auto& patch = basis.patch(triangle);
  const auto all = patch.evaluate(cell, x, 1);
  Vector<3> sum = Vector<3>::Zero();
  for (int f = 0; f < patch.num_functions(); ++f) {
    sum += c[patch.control_points()[f]] * all.row(f).transpose();
  }
  return sum;
}

// Edges of small triangles between two of them.
struct Joint {
  std::array<int, 2> triangles, cells;
  Point<2> a, b;
  bool crease = false;  // along a crease edge
  bool band = false;    // beside a small triangle in a band
};

std::vector<Joint> joints_of(const PowellSabinBasis& basis) {
  const auto& net = basis.net();
  const double unit = 1e-9 * basis.bounds().diagonal();
  std::map<std::array<long long, 2>, std::vector<std::pair<int, int>>> sides;
  std::map<std::array<long long, 2>, std::array<Point<2>, 2>> ends;
  for (int t = 0; t < static_cast<int>(net.mesh.simplices.size()); ++t) {
    for (int cell = 0; cell < PowellSabinPatch::kNumCells; ++cell) {
      const auto corners = basis.patch(t).cell(cell);
      for (int k = 0; k < 3; ++k) {
        const Point<2> middle = 0.5 * (corners[k] + corners[(k + 1) % 3]);
        const std::array key = {std::llround(middle.x() / unit), std::llround(middle.y() / unit)};
        sides[key].emplace_back(t, cell);
        ends[key] = {corners[k], corners[(k + 1) % 3]};
      }
    }
  }
  std::vector<Joint> joints;
  for (const auto& [key, of_edge] : sides) {
    if (of_edge.size() != 2) continue;
    Joint joint{{of_edge[0].first, of_edge[1].first},
                {of_edge[0].second, of_edge[1].second},
                ends[key][0],
                ends[key][1]};
    for (int s = 0; s < 2; ++s)
      joint.band |= basis.patch(joint.triangles[s]).band(joint.cells[s]) > 0;
    for (const auto& edge : net.crease_edges) {
      const Point<2>&p = net.mesh.vertices[edge.vertices[0]],
            &q = net.mesh.vertices[edge.vertices[1]];
      const double far = std::max((closest_point_on_segment(joint.a, p, q) - joint.a).norm(),
                                  (closest_point_on_segment(joint.b, p, q) - joint.b).norm());
      joint.crease |= far < unit;
    }
    joints.push_back(joint);
  }
  return joints;
}

// The largest jumps of value and gradient over joints that `wanted` chooses.
template <typename Wanted>
Vector<2> jumps(const PowellSabinBasis& basis, const Values& c, const Wanted& wanted) {
  Vector<2> most = Vector<2>::Zero();
  for (const Joint& joint : joints_of(basis)) {
    if (!wanted(joint)) continue;
    for (double s : {0.0, 0.3, 0.5, 0.8, 1.0}) {
      const Point<2> x = (1 - s) * joint.a + s * joint.b;
      const Vector<3> jump = jet(basis, c, joint.triangles[0], joint.cells[0], x) -
                             jet(basis, c, joint.triangles[1], joint.cells[1], x);
      most = most.cwiseMax(Vector<2>(std::abs(jump[0]), jump.tail<2>().norm()));
    }
  }
  return most;
}

class PowellSabinCrease : public ::testing::TestWithParam<testing::CreasedDomain> {
 protected:
  PowellSabinBasis basis{place_powell_sabin(GetParam().mesh)};
  Values random = testing::Numbers(4).columns<1>(basis.num_control_points()).transpose();
};
INSTANTIATE_TEST_SUITE_P(Kinds, PowellSabinCrease, ::testing::ValuesIn(testing::creased_domains()),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

}  // namespace

TEST_P(PowellSabinCrease, FunctionsAreNotNegativeSumToOneAndGiveTheIdentity) {
  const auto greville = basis.greville_points();
  auto points = testing::points_inside(basis.net().mesh, 6, 9);
  points.insert(points.end(), basis.net().mesh.vertices.begin(), basis.net().mesh.vertices.end());
  for (const auto& x : points) {
    const auto b = basis.evaluate(x);
    EXPECT_NEAR(b.values.sum(), 1, 1e-13);
    EXPECT_GT(b.values.minCoeff(), -1e-12);
    EXPECT_LT((greville(Eigen::all, b.control_points) * b.values - x).norm(), 1e-12);
  }
}

TEST_P(PowellSabinCrease, ContainsAllQuadratics) {
  const auto fit = project<2>(basis, [](const Point<2>& x) {
    return Vector<2>(x[0] * x[1], x[0] * x[0] - 2 * x[1] * x[1]);
  });
  EXPECT_LT(fit.max_error, 1e-10);
}

TEST_P(PowellSabinCrease, BendsAtItsLineAlone) {
  EXPECT_GT(basis.num_control_points(), 3 * std::ssize(basis.net().mesh.vertices));
  EXPECT_LT(jumps(basis, random, [](const Joint&) { return true; })[0], 1e-12);
  const auto crease = jumps(basis, random, [](const Joint& j) { return j.crease; });
  EXPECT_GT(crease[1], 0.1);
  const auto other = jumps(basis, random, [](const Joint& j) { return !j.crease && !j.band; });
  EXPECT_LT(other[1], 1e-10);
}

TEST_P(PowellSabinCrease, BandsLieOutsideBodies) {
  double in_bands = 0, in_bodies = 0, all = 0;
  for (const auto& e : basis.quadrature(0, 0)) {
    all += e.weights.sum();
    if (!e.in_band) continue;
    in_bands += e.weights.sum();
    if (!e.in_two_sided_band && e.region > 0) in_bodies += e.weights.sum();
  }
  EXPECT_NEAR(all, basis.measure(), 1e-12 * all);
  EXPECT_GT(in_bands, 0);
  EXPECT_LT(in_bands, 0.1 * all);
  EXPECT_EQ(in_bodies, 0);
}

TEST_P(PowellSabinCrease, AffineMapsAloneDoNotBend) {
  const Eigen::MatrixXd bending = BendingEnergy<2>(basis).matrix();
  const Eigen::VectorXd spectrum =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(bending, Eigen::EigenvaluesOnly).eigenvalues();
  EXPECT_LT(std::abs(spectrum[2]), 1e-12 * spectrum[spectrum.size() - 1]);
  EXPECT_GT(spectrum[3], 1e-7 * spectrum[spectrum.size() - 1]);  // no hinges that nothing holds
}

// C1 on both sides up to a straight line, no bands.
TEST(PowellSabinCreases, StraightLinesBendExactly) {
  const auto line = testing::open_line({{0.3, -testing::kHalfWidth}, {0.3, testing::kHalfWidth}});
  const PowellSabinBasis basis(place_powell_sabin(testing::domain_with({line})));
  const Values random = testing::Numbers(4).columns<1>(basis.num_control_points()).transpose();
  for (const auto& e : basis.quadrature(0, 0)) EXPECT_FALSE(e.in_band);
  EXPECT_GT(jumps(basis, random, [](const Joint& j) { return j.crease; })[1], 0.1);
  EXPECT_LT(jumps(basis, random, [](const Joint& j) { return !j.crease; })[1], 1e-10);
  const auto fit = project<2>(
      basis, [](const Point<2>& x) { return Vector<2>(std::abs(x[0] - 0.3), x[0] * x[1]); });
  EXPECT_LT(fit.max_error, 1e-10);
}

// Turned by 0.25 rad inside, fading outside, as in CreaseFitTest. Measured root mean square errors with and without
// creases: 4.5e-4 and 2.5e-3, 3.2e-4 and 1.5e-3, 1.9e-4 and 1.3e-3.
TEST(PowellSabinCreases, FitATurnedDisc) {
  const auto truth = [](const Point<2>& x) -> Vector<2> {
    const double c = std::cos(0.25), s = std::sin(0.25);
    return std::exp(-1.2 * std::max(0.0, x.norm() - 1)) *
           Vector<2>(c * x[0] - s * x[1] - x[0] + 0.2, s * x[0] + c * x[1] - x[1] - 0.1);
  };
  for (int corners : {12, 16, 24}) {
    const auto error = [&](bool creases) {
      const PowellSabinBasis basis(
          place_powell_sabin(testing::disc_domain(corners), {.creases = creases}));
      const auto system = projection_system<2>(basis, truth);
      const Eigen::SparseMatrix<double> matrix =
          system.mass + 1e-5 * BendingEnergy<2>(basis).matrix();
      const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
      const ControlPoints<2> phi = factor.solve(system.rhs.transpose().eval()).transpose();
      return projection_error<2>(basis, phi, truth).rms_error;
    };
    EXPECT_LT(error(true), 0.4 * error(false)) << corners << " corners";
  }
}

}  // namespace crease

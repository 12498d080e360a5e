// Whether splines can bend: C1 quadratics on the triangles themselves cannot, without turning their gradients
// within narrow strips, so that their bending energy is several times too high on any mesh ("lock").
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <cmath>
#include <numbers>

#include "Testing/Transforms/SampleSplines.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Energies/BendingEnergy.h"
#include "Transforms/SplineProjection.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

using Basis = std::shared_ptr<const SplineBasis<2>>;
constexpr double kSide = 40;

// Squares over [0, 40]^2, each of two triangles, inner vertices moved by up to a fifth of a square.
SimplexMesh<2> mesh_of(int cells) {
  auto mesh = testing::jittered_mesh(cells, cells, 3);
  for (auto& v : mesh.vertices) v *= kSide / (10.0 * cells);
  return mesh;
}

Basis powell_sabin(int cells) { return std::make_shared<PowellSabinBasis>(mesh_of(cells)); }
Basis triangular(int cells, const KnotOptions& options) {
  DomainMesh domain;
  domain.mesh = mesh_of(cells);
  return std::make_shared<TriangularBSplineBasis<2>>(place_knots(domain, options).net);
}

// A smooth motion and its bending energy over the domain, by components the same.
Vector<2> wave(const Point<2>& x) {
  const double k = 2 * std::numbers::pi / kSide;
  return {std::sin(k * x[0]) * std::cos(k * x[1]), std::cos(k * x[0] - 0.5) * std::sin(k * x[1])};
}

double bending(const SplineBasis<2>& basis, const ControlPoints<2>& phi) {
  return BendingEnergy<2>(basis).evaluate(phi, 1, nullptr, nullptr);
}

// E_S = 1/2 int |H|^2, with |H|^2 = 4 k^4 sin^2 or the like, of mean k^4 for each component.
double energy_of_wave() {
  const double k = 2 * std::numbers::pi / kSide;
  return 0.5 * kSide * kSide * 2 * std::pow(k, 4);
}

// Second derivatives of the motion's first component: xx, xy, yy.
Vector<3> curvature_of_wave(const Point<2>& x) {
  const double k = 2 * std::numbers::pi / kSide;
  const double value = -k * k * wave(x)[0];
  return {value, -k * k * std::cos(k * x[0]) * std::sin(k * x[1]), value};
}

// How near second derivatives of splines come to those of the motion at best, in the mean square and
// relative.
double curvature_error(const SplineBasis<2>& basis) {
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(basis.num_control_points());
  const double factors[] = {1, 2, 1};
  double truth = 0;
  const auto elements = basis.quadrature(10, 2);
  for (const auto& e : elements) {
    for (Eigen::Index q = 0; q < e.weights.size(); ++q) {
      const Vector<3> wanted = curvature_of_wave(e.points.col(q));
      for (int s = 0; s < 3; ++s) {
        const double weight = factors[s] * e.weights[q];
        truth += weight * wanted[s] * wanted[s];
        rhs(e.control_points) += weight * wanted[s] * e.hessians[s].col(q);
      }
    }
  }
  // The affine part does not matter: hold it with a little of the mass matrix.
  const Eigen::SparseMatrix<double> k = BendingEnergy<2>(basis).matrix();
  const auto mass = projection_system<2>(basis, wave).mass;
  const double tiny = 1e-10 * k.diagonal().maxCoeff() / mass.diagonal().maxCoeff();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(k + tiny * mass);
  const Eigen::VectorXd phi = factor.solve(rhs);
  return std::sqrt(std::max(0.0, 1 - rhs.dot(phi) / truth));
}

struct Landmarks {
  std::vector<Point<2>> fixed;
  std::vector<double> shift;
};

Landmarks landmarks() {
  testing::Numbers numbers(12);
  Landmarks result;
  for (int n = 0; n < 9; ++n) {
    result.fixed.emplace_back(Point<2>(kSide / 2, kSide / 2) +
                              Vector<2>(numbers.columns<2>(1, 0.45 * kSide)));
    result.shift.push_back(numbers());
  }
  return result;
}

// The least bending energy of one component that meets the landmarks exactly.
double least_bending(const SplineBasis<2>& basis, const Landmarks& marks) {
  const Eigen::SparseMatrix<double> k = BendingEnergy<2>(basis).matrix();
  const Eigen::Index n = k.rows(), rows = std::ssize(marks.fixed);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index c = 0; c < n; ++c) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(k, c); it; ++it) {
      entries.emplace_back(it.row(), c, it.value());
    }
  }
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(n + rows);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const auto b = basis.evaluate(marks.fixed[r]);
    for (std::size_t i = 0; i < b.control_points.size(); ++i) {
      entries.emplace_back(n + r, b.control_points[i], b.values[i]);
      entries.emplace_back(b.control_points[i], n + r, b.values[i]);
    }
    rhs[n + r] = marks.shift[r];
  }
  Eigen::SparseMatrix<double> system(n + rows, n + rows);
  system.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> factor(system);
  const Eigen::VectorXd phi = factor.solve(rhs).head(n);
  return 0.5 * phi.dot(k * phi);
}

}  // namespace

// Measured: 1.190, 1.046, 1.014 for Powell-Sabin splines, 7.2, 4.6, 2.2 for quadratics on the triangles.
TEST(PowellSabinBending, ApproximatesAMotionWithItsBendingEnergy) {
  const auto excess = [](const Basis& basis) {
    const auto fit = project<2>(*basis, wave);
    return bending(*basis, fit.control_points) / energy_of_wave() - 1;
  };
  double before = 0;
  for (int cells : {4, 8, 16}) {
    const double own = excess(powell_sabin(cells));
    EXPECT_GT(own, 0);
    EXPECT_LT(own, cells == 4 ? 0.3 : 0.35 * before);  // second order
    if (cells < 16) EXPECT_GT(excess(triangular(cells, {.degree = 2})), 15 * own);
    before = own;
  }
}

// Measured: 0.365, 0.189, 0.102 for Powell-Sabin splines, 0.70, 0.57, 0.41 for quadratics on the
// triangles, although these have more functions.
TEST(PowellSabinBending, HasSecondDerivativesOfFirstOrder) {
  double before = 0;
  for (int cells : {4, 8, 16}) {
    const double own = curvature_error(*powell_sabin(cells));
    EXPECT_LT(own, cells == 4 ? 0.45 : 0.6 * before);
    if (cells < 16) EXPECT_GT(curvature_error(*triangular(cells, {.degree = 2})), 1.7 * own);
    before = own;
  }
}

// The splines with the least energy that meet the landmarks approach the thin plate's from above; a fine
// tensor-product spline's energy stands for that. Measured excess: 2.0, 0.67, 0.21 of it for
// Powell-Sabin splines, 1.7 for quadratics on the triangles with 8 cells.
TEST(PowellSabinBending, MeetsLandmarksWithLittleEnergy) {
  const auto marks = landmarks();
  const double least = least_bending(*testing::box_basis<2>(48, kSide), marks);
  double before = 4 * least;
  for (int cells : {4, 8, 16}) {
    const double own = least_bending(*powell_sabin(cells), marks) - least;
    EXPECT_GT(own, 0);
    EXPECT_LT(own, 0.5 * before);
    if (cells == 8) {
      const double other = least_bending(*triangular(cells, {.degree = 2}), marks) - least;
      EXPECT_GT(other, 2 * own);
    }
    before = own;
  }
}

}  // namespace crease

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "Core/Parallel.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/Splines/KnotCongruence.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

using Elements = std::vector<QuadratureElement<2>>;

enum class Matrix { kMass, kStiffness, kBending };

// integral of B_i B_k, grad B_i . grad B_k, or H_i : H_k.
Eigen::MatrixXd assemble(const TriangularBSplineBasis<2>& basis, const Elements& elements,
                         Matrix kind, bool skip_bands = false) {
  const int n = basis.num_control_points();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (const auto& e : elements) {
    if (skip_bands && e.in_band) continue;
    const auto& w = e.weights.asDiagonal();
    Eigen::MatrixXd local;
    if (kind == Matrix::kMass) local = e.values * w * e.values.transpose();
    if (kind == Matrix::kStiffness) {
      local = e.gradients[0] * w * e.gradients[0].transpose() +
              e.gradients[1] * w * e.gradients[1].transpose();
    }
    if (kind == Matrix::kBending) {
      local = e.hessians[0] * w * e.hessians[0].transpose() +
              2.0 * e.hessians[1] * w * e.hessians[1].transpose() +
              e.hessians[2] * w * e.hessians[2].transpose();
    }
    A(e.control_points, e.control_points) += local;
  }
  return A;
}

std::vector<KnotNet<2>> nets_of_degree(int degree) {
  return {testing::jittered_net(3, 3, degree, 0.4, 1), testing::straight_crease_net(degree, 0.4),
          testing::ring_net(degree, 0.4, true)};
}

// Eight triangles with a crease through the middle: small, for many points per cell.
KnotNet<2> creased_square(int degree) {
  auto net = testing::spread_knots(testing::grid_mesh(2, 2), degree, 0.4);
  for (int k = 1; k < degree; ++k) {
    const int pair = (k + 1) / 2;
    net.clouds[4][k] = Point<2>(10.0, 10.0 + (k % 2 == 1 ? 1.2 : -1.0) / pair);
    net.clouds[1][k] = Point<2>(10.0, -1.0 + 0.2 * k);
    net.clouds[7][k] = Point<2>(10.0, 21.0 - 0.2 * k);
  }
  net.crease_edges = {{{1, 4}, false}, {{4, 7}, false}};
  return net;
}

// Moments of the simplex splines in closed form (Hermite-Genocchi), summed over each shared function.
TEST(TriangularBSplineQuadrature, HasTheMomentsOfTheFunctions) {
  for (int degree = 1; degree <= 4; ++degree) {
    // Only functions whose support lies in the domain have their whole integral there.
    const auto net = testing::jittered_net(4, 4, degree, 0.4, 1);
    const TriangularBSplineBasis<2> basis(net);
    const auto elements = basis.quadrature(degree + 2, 0);
    Eigen::MatrixXd found = Eigen::MatrixXd::Zero(basis.num_control_points(), 6), truth = found;
    for (const auto& e : elements) {
      for (Eigen::Index q = 0; q < e.weights.size(); ++q) {
        const double x = e.points(0, q), y = e.points(1, q);
        const Eigen::Matrix<double, 1, 6> monomials(1, x, y, x * x, x * y, y * y);
        for (std::size_t i = 0; i < e.control_points.size(); ++i) {
          found.row(e.control_points[i]) += e.weights[q] * e.values(i, q) * monomials;
        }
      }
    }
    std::vector<char> inner(basis.num_control_points(), 1);
    const auto betas = multi_indices<2>(degree);
    for (std::size_t t = 0; t < net.mesh.simplices.size(); ++t) {
      for (std::size_t k = 0; k < betas.size(); ++k) {
        const int i = basis.control_points_of(static_cast<int>(t))[k];
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
        std::array<Point<2>, 3> x;
        for (int j = 0; j < 3; ++j) {
          const auto& cloud = net.clouds[net.mesh.simplices[t][j]];
          for (int l = 0; l <= betas[k][j]; ++l) {
            const Point<2>& knot = cloud[l == degree ? 0 : l];
            if (knot.minCoeff() < -1e-9 || knot.maxCoeff() > 40 + 1e-9) inner[i] = 0;
            sum += knot;
            squares += knot * knot.transpose();
          }
          x[j] = cloud[betas[k][j] == degree ? 0 : betas[k][j]];
        }
        const double size = degree + 3.0;
        const double mass = signed_content<2>(x) / ((degree + 1.0) * (degree + 2.0));
        const Eigen::Matrix2d second = (squares + sum * sum.transpose()) / (size * (size + 1.0));
        Eigen::Matrix<double, 1, 6> moments;
        moments << 1.0, sum[0] / size, sum[1] / size, second(0, 0), second(0, 1), second(1, 1);
        truth.row(i) += mass * moments;
      }
    }
    int checked = 0;
    for (int i = 0; i < basis.num_control_points(); ++i) {
      if (!inner[i]) continue;
      ++checked;
      EXPECT_LT((found.row(i) - truth.row(i)).norm(), 1e-12 * truth.row(i).norm())
          << "degree " << degree;
    }
    EXPECT_GT(checked, 5 * degree);
  }
}

TEST(TriangularBSplineQuadrature, CoversTheDomainAndSumsToOne) {
  for (int degree = 1; degree <= 3; ++degree) {
    for (const auto& net : nets_of_degree(degree)) {
      const TriangularBSplineBasis<2> basis(net);
      double area = 0.0;
      for (const auto& e : basis.quadrature(2, 2)) {
        area += e.weights.sum();
        EXPECT_EQ(e.region, net.mesh.region(e.patch));
        EXPECT_TRUE(std::is_sorted(e.control_points.begin(), e.control_points.end()));
        for (Eigen::Index q = 0; q < e.weights.size(); ++q) {
          EXPECT_NEAR(e.values.col(q).sum(), 1.0, 1e-10);
          const auto b = basis.evaluate(e.points.col(q), 1);
          Eigen::VectorXd difference = Eigen::VectorXd::Zero(basis.num_control_points());
          for (std::size_t i = 0; i < b.control_points.size(); ++i) {
            difference[b.control_points[i]] += b.gradients(1, i);
          }
          for (std::size_t i = 0; i < e.control_points.size(); ++i) {
            difference[e.control_points[i]] -= e.gradients[1](i, q);
          }
          EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-9);
        }
      }
      EXPECT_NEAR(area, basis.measure(), 1e-12 * basis.measure());
    }
  }
}

TEST(TriangularBSplineQuadrature, IsExact) {
  for (int degree = 2; degree <= 4; ++degree) {
    for (const auto& net : {testing::jittered_net(2, 2, degree, 0.4, 1), creased_square(degree)}) {
      const TriangularBSplineBasis<2> basis(net);
      const Matrix kinds[3] = {Matrix::kMass, Matrix::kStiffness, Matrix::kBending};
      for (int d = 0; d < 3; ++d) {
        const int exact = 2 * (degree - d);
        const auto A = assemble(basis, basis.quadrature(exact, d), kinds[d]);
        const auto B = assemble(basis, basis.quadrature(exact + 4, d), kinds[d]);
        EXPECT_LT((A - B).norm(), (d < 2 ? 1e-12 : 1e-11) * B.norm())
            << "degree " << degree << ", " << d;
      }
    }
  }
}

TEST(TriangularBSplineQuadrature, BendingMatrixHasTheAffineKernel) {
  for (int degree = 2; degree <= 4; ++degree) {
    for (const auto& net : {testing::jittered_net(3, 3, degree, 0.4, 1),
                            testing::ring_net(std::min(degree, 3), 0.4, true)}) {
      const TriangularBSplineBasis<2> basis(net);
      const auto A =
          assemble(basis, basis.quadrature(2 * (net.degree - 2), 2), Matrix::kBending, true);
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A, Eigen::EigenvaluesOnly);
      const auto& spectrum = solver.eigenvalues();
      const double largest = spectrum[spectrum.size() - 1];
      EXPECT_EQ((spectrum.array() < 1e-12 * largest).count(), 3) << "degree " << degree;
      EXPECT_GT(spectrum[3], 1e-8 * largest) << "degree " << degree;
      Eigen::MatrixXd affine(A.rows(), 3);
      affine << Eigen::VectorXd::Ones(A.rows()), basis.greville_points().transpose();
      EXPECT_LT((A * affine).norm(), 1e-12 * A.norm() * affine.norm()) << "degree " << degree;
    }
  }
}

TEST(TriangularBSplineQuadrature, CouplingsHoldAllPairs) {
  for (int degree = 1; degree <= 4; ++degree) {
    for (const auto& net : nets_of_degree(degree)) {
      const TriangularBSplineBasis<2> basis(net);
      const auto couplings = basis.couplings();
      EXPECT_TRUE(std::is_sorted(couplings.begin(), couplings.end()));
      Eigen::MatrixXi coupled =
          Eigen::MatrixXi::Zero(basis.num_control_points(), basis.num_control_points());
      for (const auto& [i, k] : couplings) {
        ASSERT_LE(i, k);
        coupled(i, k) = 1;
      }
      Eigen::MatrixXi met = Eigen::MatrixXi::Zero(coupled.rows(), coupled.cols());
      for (const auto& e : basis.quadrature(1, 0)) {
        for (std::size_t a = 0; a < e.control_points.size(); ++a) {
          for (std::size_t b = a; b < e.control_points.size(); ++b) {
            const bool both = (e.values.row(a).array() * e.values.row(b).array() != 0.0).any();
            if (both) met(e.control_points[a], e.control_points[b]) = 1;
          }
        }
      }
      EXPECT_EQ((met.array() > coupled.array()).count(), 0);
      // Few more than those that really meet.
      EXPECT_LT(coupled.sum(), 1.35 * met.sum()) << "degree " << degree;
    }
  }
}

// On a structured mesh most triangles are moved copies of two; each must still be its own integral.
TEST(TriangularBSplineQuadrature, MovedElementsAreThoseOfTheirTriangles) {
  const auto net = testing::spread_knots(testing::grid_mesh(7, 6), 3, 0.4, true);
  const KnotCongruence congruence(net);
  int moved = 0;
  for (int t = 0; t < 84; ++t) moved += congruence.representative(t) != t;
  EXPECT_GE(moved, 20);
  const TriangularBSplineBasis<2> basis(net);
  for (const auto& e : basis.quadrature(2, 2)) {
    EXPECT_TRUE(std::is_sorted(e.control_points.begin(), e.control_points.end()));
    for (Eigen::Index q = 0; q < e.weights.size(); ++q) {
      EXPECT_EQ(basis.find_simplex(e.points.col(q)), e.patch);
      const auto b = basis.evaluate(e.points.col(q), 2);
      Eigen::VectorXd difference = Eigen::VectorXd::Zero(basis.num_control_points());
      for (std::size_t i = 0; i < b.control_points.size(); ++i) {
        difference[b.control_points[i]] += b.hessians(1, i);
      }
      for (std::size_t i = 0; i < e.control_points.size(); ++i) {
        difference[e.control_points[i]] -= e.hessians[1](i, q);
      }
      EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

TEST(TriangularBSplineQuadrature, TakesWantedPatchesOnly) {
  const TriangularBSplineBasis<2> basis(testing::ring_net(3, 0.4, true));
  double area = 0.0;
  for (const auto& e : basis.quadrature(2, 0, [](int region, int) { return region == 1; })) {
    EXPECT_EQ(e.region, 1);
    area += e.weights.sum();
  }
  EXPECT_NEAR(area, 3.0, 1e-9);  // a 12-gon of radius 1
}

TEST(TriangularBSplineQuadrature, HasTheSameBytesOnAnyNumberOfThreads) {
  const TriangularBSplineBasis<2> basis(testing::ring_net(3, 0.4, true));
  set_num_threads(1);
  const auto expected = basis.quadrature(2, 2);
  for (int threads : {2, 8}) {
    set_num_threads(threads);
    const auto found = basis.quadrature(2, 2);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].control_points, expected[i].control_points);
      ASSERT_TRUE(found[i].hessians[1] == expected[i].hessians[1]);
      ASSERT_TRUE(found[i].weights == expected[i].weights);
    }
  }
  set_num_threads(0);
}

}  // namespace
}  // namespace crease

#include "Transforms/Splines/TriangularBSplineGrid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "Core/Cpu.h"
#include "Core/Parallel.h"
#include "Testing/Transforms/Splines/TestNets.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

constexpr int kTileRows = 16;

// 40 x 40 mm and a margin, anisotropic, turned by 0.3 rad, with the second axis mirrored or not; or with
// `finer` as many samples along each axis.
Raster<2> turned_raster(bool mirrored, double finer = 1) {
  Raster<2> raster;
  raster.size = {static_cast<int>(131 * finer), static_cast<int>(97 * finer)};
  raster.spacing = {0.53 / finer, 0.71 / finer};
  raster.direction << std::cos(0.3), -std::sin(0.3), std::sin(0.3), std::cos(0.3);
  if (mirrored) raster.direction.col(1) *= -1.0;
  raster.origin = Point<2>(20, 20) - raster.index_to_point() * Vector<2>(65, 48) * finer;
  return raster;
}

// Pixels on edges, vertices and knot lines of the straight crease's net.
Raster<2> aligned_raster() {
  Raster<2> raster;
  raster.size = {81, 81};
  raster.spacing = {0.5, 0.5};
  return raster;
}

ControlPoints<2> random_points(int count, int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  ControlPoints<2> points(2, count);
  for (auto& v : points.reshaped()) v = uniform(random);
  return points;
}

// Maps or forces on the samples: component after component, samples outside 0.
using Field = std::array<std::vector<float>, 2>;

Field map_all(const BoundGrid<2>& grid, const ControlPoints<2>& points) {
  const auto& raster = grid.raster();
  Field field;
  for (auto& f : field) f.assign(raster.num_samples(), 0.0f);
  const auto coefficients = grid.prepare(points);
  std::vector<float> x(padded_row_size(raster), 7.0f), y = x;
  for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
    grid.map_row(*coefficients, r, {x.data(), y.data()});
    const auto [begin, end] = grid.row_range(r);
    std::copy(x.begin() + begin, x.begin() + end, field[0].begin() + r * raster.size[0] + begin);
    std::copy(y.begin() + begin, y.begin() + end, field[1].begin() + r * raster.size[0] + begin);
  }
  return field;
}

ControlPoints<2> adjoint(const BoundGrid<2>& grid, const Field& forces) {
  const auto& raster = grid.raster();
  const std::int64_t tiles = (raster.num_rows() + kTileRows - 1) / kTileRows;
  std::vector<std::unique_ptr<BoundGrid<2>::Accumulator>> sums(tiles);
  parallel_for(tiles, [&](std::int64_t t) {
    sums[t] = grid.new_accumulator();
    std::vector<float> x(padded_row_size(raster), std::nanf("")),
        y = x;  // what is outside is not read
    for (std::int64_t r = t * kTileRows; r < std::min((t + 1) * kTileRows, raster.num_rows());
         ++r) {
      std::copy_n(forces[0].begin() + r * raster.size[0], raster.size[0], x.begin());
      std::copy_n(forces[1].begin() + r * raster.size[0], raster.size[0], y.begin());
      grid.add_row(*sums[t], r, {x.data(), y.data()});
    }
  });
  ControlPoints<2> gradient = ControlPoints<2>::Zero(2, grid.num_control_points());
  grid.finish(sums, gradient);
  return gradient;
}

Field random_forces(const BoundGrid<2>& grid, int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  Field forces;
  for (auto& f : forces) {
    f.resize(grid.raster().num_samples());
    for (float& v : f) v = uniform(random);
  }
  return forces;
}

TEST(TriangularBSplineGrid, MapsAsPointEvaluationDoes) {
  for (const auto& net : testing::nets_of_all_degrees()) {
    const TriangularBSplineBasis<2> basis(net);
    const auto points = random_points(basis.num_control_points(), 1);
    for (const auto& raster : {turned_raster(false), turned_raster(true), aligned_raster()}) {
      const auto grid = basis.bind(raster);
      const auto field = map_all(*grid, points);
      std::vector<std::uint8_t> inside(raster.size[0]);
      double largest = 0.0;
      for (int j = 0; j < raster.size[1]; ++j) {
        grid->coverage(j, inside);
        const auto [begin, end] = grid->row_range(j);
        for (int i = 0; i < raster.size[0]; ++i) {
          const Point<2> x = raster.point({i, j});
          ASSERT_EQ(inside[i] != 0, basis.contains(x)) << i << ", " << j;
          if (inside[i]) ASSERT_TRUE(i >= begin && i < end);
          Point<2> truth(0, 0);
          if (inside[i]) {
            const auto b = basis.evaluate(x);
            for (std::size_t k = 0; k < b.control_points.size(); ++k) {
              truth += b.values[k] * points.col(b.control_points[k]);
            }
          }
          for (int a = 0; a < 2; ++a) {
            largest = std::max(largest, std::abs(field[a][j * raster.size[0] + i] - truth[a]));
          }
        }
      }
      // Single precision, |phi| <= 1; the sums grow longer with the degree.
      EXPECT_LT(largest, 4e-7 * net.degree) << "degree " << net.degree;
    }
  }
}

TEST(TriangularBSplineGrid, AdjointIsTheTransposedMap) {
  for (const auto& net : testing::nets_of_all_degrees()) {
    const TriangularBSplineBasis<2> basis(net);
    const auto points = random_points(basis.num_control_points(), 2);
    const auto grid = basis.bind(turned_raster(false));
    const auto forces = random_forces(*grid, 3);
    const auto field = map_all(*grid, points);
    const auto gradient = adjoint(*grid, forces);
    double forward = 0.0, size = 0.0;
    for (int a = 0; a < 2; ++a) {
      for (std::size_t i = 0; i < field[a].size(); ++i) {
        forward += static_cast<double>(field[a][i]) * forces[a][i];
        size += std::abs(static_cast<double>(field[a][i]) * forces[a][i]);
      }
    }
    const double backward = points.cwiseProduct(gradient).sum();
    EXPECT_NEAR(forward, backward, 1e-8 * size) << "degree " << net.degree;
  }
}

TEST(TriangularBSplineGrid, AdjointOfOneForceIsTheBasisThere) {
  const TriangularBSplineBasis<2> basis(testing::straight_crease_net(3, 0.4));
  const auto raster = turned_raster(true);
  const auto grid = basis.bind(raster);
  for (const std::array<int, 2> pixel :
       {std::array{60, 48}, {65, 48}, {40, 30}, {71, 60}, {66, 12}}) {
    const Point<2> x = raster.point({pixel[0], pixel[1]});
    if (!basis.contains(x)) continue;
    Field forces;
    for (auto& f : forces) f.assign(raster.num_samples(), 0.0f);
    forces[0][pixel[1] * raster.size[0] + pixel[0]] = 2.0f;
    forces[1][pixel[1] * raster.size[0] + pixel[0]] = -1.0f;
    ControlPoints<2> difference = adjoint(*grid, forces);
    const auto b = basis.evaluate(x);
    for (std::size_t k = 0; k < b.control_points.size(); ++k) {
      difference.col(b.control_points[k]) -= b.values[k] * Vector<2>(2.0, -1.0);
    }
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-7);
  }
}

// The samples that stand for a block: the covered one nearest to its middle, or all that are covered.
std::vector<Point<2>> block_samples(const TriangularBSplineBasis<2>& basis, const Raster<2>& raster,
                                    int bi, int bj, bool all) {
  std::vector<Point<2>> samples;
  double least = std::numeric_limits<double>::infinity();
  for (int j = 4 * bj; j < std::min(4 * bj + 4, raster.size[1]); ++j) {
    for (int i = 4 * bi; i < std::min(4 * bi + 4, raster.size[0]); ++i) {
      const Point<2> x = raster.point({i, j});
      if (!basis.contains(x)) continue;
      const double distance = std::hypot(i - 4 * bi - 2, j - 4 * bj - 2);
      if (!all && distance >= least) continue;
      if (!all) samples.clear();
      least = distance;
      samples.push_back(x);
    }
  }
  return samples;
}

void expect_block_products(const TriangularBSplineBasis<2>& basis, const Raster<2>& raster,
                           bool all) {
  const int n = basis.num_control_points();
  CurvatureBlocks<2> blocks(raster.size);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  for (auto& component : blocks.sums) {
    for (float& v : component) v = uniform(random);
  }
  BlockHessian<2> hessian(std::make_shared<HessianPattern>(n, basis.couplings()));
  hessian.set_zero();
  basis.bind(raster)->add_curvature(blocks, 0.5, hessian);

  Eigen::MatrixXd truth = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (int bj = 0; bj < blocks.blocks[1]; ++bj) {
    for (int bi = 0; bi < blocks.blocks[0]; ++bi) {
      const std::size_t block = bj * blocks.blocks[0] + bi;
      Matrix<2> g;
      g << blocks.sums[0][block], blocks.sums[1][block], blocks.sums[1][block],
          blocks.sums[2][block];
      const auto samples = block_samples(basis, raster, bi, bj, all);
      for (const Point<2>& x : samples) {
        const auto b = basis.evaluate(x);
        for (std::size_t k = 0; k < b.control_points.size(); ++k) {
          for (std::size_t l = 0; l < b.control_points.size(); ++l) {
            truth.block<2, 2>(2 * b.control_points[k], 2 * b.control_points[l]) +=
                0.5 / std::ssize(samples) * b.values[k] * b.values[l] * g;
          }
        }
      }
    }
  }
  const Eigen::MatrixXd lower = hessian.to_sparse();
  const Eigen::MatrixXd expected = truth.triangularView<Eigen::Lower>();
  EXPECT_LT((lower - expected).norm(), 1e-6 * truth.norm());
}

// One sample stands for a block where control points are at least 16 samples apart (in strips; 4 in cores),
// all samples do where they are less than 2.
TEST(TriangularBSplineGrid, CurvatureIsTheSumOfBlockProducts) {
  for (int degree = 1; degree <= 4; ++degree) {
    SCOPED_TRACE(degree);
    const TriangularBSplineBasis<2> basis(testing::jittered_net(4, 4, degree, 0.4, degree));
    expect_block_products(basis, turned_raster(false, 16), false);
    expect_block_products(basis, turned_raster(false, 0.125), true);
  }
}

TEST(TriangularBSplineGrid, HasTheSameBytesOnAnyNumberOfThreads) {
  const auto net = testing::straight_crease_net(3, 0.4);
  const auto raster = turned_raster(false);
  ControlPoints<2> expected_gradient;
  Field expected_field;
  for (int threads : {1, 2, 8}) {
    set_num_threads(threads);
    const TriangularBSplineBasis<2> basis(net);
    const auto grid = basis.bind(raster);
    const auto field = map_all(*grid, random_points(basis.num_control_points(), 2));
    const auto gradient = adjoint(*grid, random_forces(*grid, 3));
    if (threads == 1) {
      expected_field = field;
      expected_gradient = gradient;
    }
    EXPECT_TRUE(field == expected_field);
    EXPECT_TRUE(gradient == expected_gradient);
  }
  set_num_threads(0);
}

// One row by hand: a cubic core, a strip, a gap, a strip; each sample against its formula.
TEST(TriangularBSplineGridKernels, MapAndAdjointFollowTheFormulas) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  const std::vector<GridRun> runs = {{3, 21, 0, 0, 0, 0},
                                     {24, 13, GridRun::kStrip, 5, 0, 0},
                                     {37, 4, GridRun::kOutside, 0, 0, 0},
                                     {41, 6, GridRun::kStrip, 3, 5, 65}};
  const GridPatch patch{11.0, 2.5, 1.0 / 30.0};
  const std::vector<int> numbers = {0, 2, 3, 5, 6, 1, 2, 4};
  std::vector<float> weights(5 * 13 + 3 * 6 + 16), core(4 * 8), points(2 * 7);
  for (auto* v : {&weights, &core, &points}) {
    for (float& x : *v) x = uniform(random);
  }
  const GridRow row{runs.data(), 4, 5, 3, &patch, numbers.data(), weights.data()};
  std::vector<float> force_x(64), force_y(64);
  for (auto* v : {&force_x, &force_y}) {
    for (float& x : *v) x = uniform(random);
  }

  std::vector<double> truth_x(64, 0.0), truth_y(64, 0.0), gradient(14, 0.0), moments(32, 0.0);
  for (int i = 3; i < 24; ++i) {
    const double X = (i - 11.0) / 30.0, Y = 2.5 / 30.0;
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 4; ++k) {
        const double power = std::pow(X, k) * std::pow(Y, j);
        truth_x[i] += core[8 * j + k] * power;
        truth_y[i] += core[8 * j + 4 + k] * power;
        moments[8 * j + k] += force_x[i] * power;
        moments[8 * j + 4 + k] += force_y[i] * power;
      }
    }
  }
  for (const auto& run : {runs[1], runs[3]}) {
    for (int k = 0; k < run.num_points; ++k) {
      const int c = numbers[run.points_start + k];
      for (int i = 0; i < run.count; ++i) {
        const double w = weights[run.weights_start + k * run.count + i];
        truth_x[run.first + i] += w * points[2 * c];
        truth_y[run.first + i] += w * points[2 * c + 1];
        gradient[2 * c] += w * force_x[run.first + i];
        gradient[2 * c + 1] += w * force_y[run.first + i];
      }
    }
  }

  const int slot = 0;
  for (const bool avx2 : {false, true}) {
    if (avx2 && !cpu_has_avx2()) continue;
    std::vector<float> x(80, 9.0f), y(80, 9.0f);
    (avx2 ? avx2::grid_map_row : baseline::grid_map_row)(row, core.data(), points.data(), x.data(),
                                                         y.data());
    for (int i = 3; i < 47; ++i) {
      EXPECT_NEAR(x[i], truth_x[i], 2e-6) << i;
      EXPECT_NEAR(y[i], truth_y[i], 2e-6) << i;
    }
    const std::vector<int> point_slot = {3, 0, 1, 6, 5, 2, 4};
    std::vector<float> sums(16 * 7, 0.0f);
    std::vector<double> found_moments(32, 0.0);
    (avx2 ? avx2::grid_adjoint_row : baseline::grid_adjoint_row)(
        row, force_x.data(), force_y.data(), &slot, found_moments.data(), point_slot.data(),
        sums.data());
    for (int i = 0; i < 14; ++i) {
      const auto lanes = sums.begin() + 16 * point_slot[i / 2] + 8 * (i % 2);
      EXPECT_NEAR(std::accumulate(lanes, lanes + 8, 0.0), gradient[i], 1e-5);
    }
    for (int i = 0; i < 32; ++i) EXPECT_NEAR(found_moments[i], moments[i], 1e-5);
  }
}

TEST(TriangularBSplineGrid, CountsCoreAndStripSamples) {
  const TriangularBSplineBasis<2> basis(testing::jittered_net(4, 4, 3, 0.3, 1));
  Raster<2> raster;
  raster.size = {401, 401};
  raster.spacing = {0.1, 0.1};
  const auto grid = basis.bind(raster);
  const auto& bound = dynamic_cast<const TriangularBSplineGrid&>(*grid);
  EXPECT_EQ(bound.num_core_samples() + bound.num_strip_samples(), 401 * 401);
  // The theory measures a core share of 0.74 for cubics and alpha = 0.3.
  EXPECT_NEAR(static_cast<double>(bound.num_core_samples()) / (401 * 401), 0.74, 0.08);
  EXPECT_GT(bound.strip_bytes(), 0);
}

TEST(TriangularBSplineGrid, LeavesRastersBesideTheDomainUncovered) {
  const TriangularBSplineBasis<2> basis(testing::jittered_net(2, 2, 3, 0.3, 1));
  Raster<2> raster;
  raster.size = {30, 9};
  raster.origin = {500, 0};
  const auto grid = basis.bind(raster);
  std::vector<std::uint8_t> inside(30, 1);
  grid->coverage(4, inside);
  EXPECT_EQ(std::count(inside.begin(), inside.end(), 1), 0);
  EXPECT_EQ(grid->row_range(4).first, grid->row_range(4).second);
}

}  // namespace
}  // namespace crease

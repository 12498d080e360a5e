// A basis bound to a raster agrees with the basis itself, whichever way it is bound.
#include "Transforms/BoundGrid.h"

#include <gmock/gmock.h>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Testing/Transforms/SampleCentres.h"
#include "Testing/Transforms/SampleNurbs.h"
#include "Transforms/Domains/StructuredTriangulation.h"
#include "Transforms/LatticeGrid.h"
#include "Transforms/SparseRowGrid.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/TensorBSplineGrid.h"

namespace crease {
namespace {

/// A raster over the small lattice that also leaves it on every side; odd sizes.
template <int Dim>
Raster<Dim> raster_over(const TensorLattice<Dim>& lattice) {
  const int size[] = {53, 41, 11};
  Raster<Dim> raster;
  raster.direction = lattice.direction;
  Vector<Dim> corner;
  for (int a = 0; a < Dim; ++a) {
    raster.size[a] = size[a];
    raster.spacing[a] = 1.15 * lattice.spans[a] * lattice.spacing[a] / size[a];
    corner[a] = -0.04 * lattice.spans[a];
  }
  raster.origin = lattice.point(corner);
  return raster;
}

template <int Dim, int Degree, bool Separable>
struct Kind {
  static constexpr int kDim = Dim;
  static constexpr bool kEverywhere = false, kOnLattice = false;
  static std::shared_ptr<const SplineBasis<Dim>> make() {
    return testing::small_basis<Dim>(Degree);
  }
  static std::unique_ptr<BoundGrid<Dim>> bind(const SplineBasis<Dim>& basis,
                                              const Raster<Dim>& raster) {
    if (Separable) {
      return std::make_unique<TensorBSplineGrid<Dim>>(testing::small_lattice<Dim>(), Degree,
                                                      raster);
    }
    return std::make_unique<SparseRowGrid<Dim>>(basis, raster);
  }
};

/// On triangles over the same lattice.
template <bool Own>
struct PowellSabinKind {
  static constexpr int kDim = 2;
  static constexpr bool kEverywhere = false, kOnLattice = false;
  static std::shared_ptr<const SplineBasis<2>> make() {
    const auto lattice = testing::small_lattice<2>();
    Box<2> box;
    box.add({0, 0});
    box.add({double(lattice.spans[0]), double(lattice.spans[1])});
    auto mesh = structured_triangulation(box, 3, 2);
    for (auto& v : mesh.vertices) v = lattice.point(v);
    return std::make_shared<PowellSabinBasis>(std::move(mesh));
  }
  static std::unique_ptr<BoundGrid<2>> bind(const SplineBasis<2>& basis, const Raster<2>& raster) {
    if (Own) return basis.bind(raster);
    return std::make_unique<SparseRowGrid<2>>(basis, raster);
  }
};

/// As the basis binds itself.
template <int Dim>
struct Bound {
  static constexpr int kDim = Dim;
  static constexpr bool kEverywhere = false, kOnLattice = false;
  static std::unique_ptr<BoundGrid<Dim>> bind(const SplineBasis<Dim>& basis,
                                              const Raster<Dim>& raster) {
    return basis.bind(raster);
  }
};

template <int Dim, int Degree, bool Rational>
struct Nurbs : Bound<Dim> {
  static std::shared_ptr<const SplineBasis<Dim>> make() {
    const auto lattice = testing::small_lattice<Dim>();
    return std::make_shared<NurbsBasis<Dim>>(Rational ? testing::rational_net<Dim>(lattice, Degree)
                                                      : testing::nurbs_net<Dim>(lattice, Degree));
  }
};

/// A rational one by tables.
template <int Dim>
struct NurbsTables : Nurbs<Dim, 3, true> {
  static std::unique_ptr<BoundGrid<Dim>> bind(const SplineBasis<Dim>& basis,
                                              const Raster<Dim>& raster) {
    return std::make_unique<SparseRowGrid<Dim>>(basis, raster);
  }
};

struct TSpline : Bound<2> {
  static std::shared_ptr<const SplineBasis<2>> make() {
    return testing::tspline(testing::small_lattice<2>(), 3);
  }
};

/// Thin plates, whose domain is all of space, by tables or through a lattice.
template <int Dim, bool OnLattice>
struct ThinPlates {
  static constexpr int kDim = Dim;
  static constexpr bool kEverywhere = true, kOnLattice = OnLattice;
  static constexpr double kStep = 1.4;  // mm: some small blocks
  static std::shared_ptr<const SplineBasis<Dim>> make() {
    Box<Dim> box;
    for (const auto& x : testing::points_inside<Dim>(testing::small_lattice<Dim>(), 50)) box.add(x);
    return testing::thin_plates_over<Dim>(box, 3);
  }
  static std::unique_ptr<BoundGrid<Dim>> bind(const SplineBasis<Dim>& basis,
                                              const Raster<Dim>& raster) {
    if (!OnLattice) return std::make_unique<SparseRowGrid<Dim>>(basis, raster);
    const auto& plates = dynamic_cast<const ThinPlateBasis<Dim>&>(basis);
    return std::make_unique<LatticeGrid<Dim>>(
        [&](const ControlPoints<Dim>& x) { return plates.values(x); }, plates.num_control_points(),
        raster, plates.mean_edge_length() / 8, kStep);
  }
};

}  // namespace

template <typename T>
class BoundGridSuite : public ::testing::Test {
 public:
  static constexpr int kDim = T::kDim;
  std::shared_ptr<const SplineBasis<kDim>> basis = T::make();
  Raster<kDim> raster = raster_over<kDim>(testing::small_lattice<kDim>());
  std::unique_ptr<BoundGrid<kDim>> grid = T::bind(*basis, raster);
  ControlPoints<kDim> phi = testing::Numbers(2).columns<kDim>(basis->num_control_points(), 3.0);

  /// Of single precision, or of the lattice: in 3D plates have kinks, -r, that it rounds off.
  static constexpr double kMapError = !T::kOnLattice ? 2e-6 : kDim == 2 ? 0.1 : 0.4;

  Point<kDim> sample(std::int64_t row, int i) const {
    return raster.row_start(row) + i * raster.index_to_point().col(0);
  }
  using Rows = std::array<std::vector<float>, kDim>;
  Rows buffers(float fill) const {
    Rows rows;
    for (auto& row : rows) row.assign(padded_row_size(raster), fill);
    return rows;
  }
  /// Forces that are not a number outside the domain, where they must not count.
  Rows forces(std::int64_t row) const {
    Rows rows = buffers(std::nanf(""));
    testing::Numbers numbers(static_cast<unsigned>(row + 1));
    const auto [begin, end] = grid->row_range(row);
    for (auto& r : rows) {
      for (int i = begin; i < end; ++i) r[i] = static_cast<float>(numbers());
    }
    return rows;
  }
  /// The adjoint of those forces in tiles of four rows on the threads there are.
  ControlPoints<kDim> adjoint() const {
    std::vector<std::unique_ptr<typename BoundGrid<kDim>::Accumulator>> tiles;
    for (std::int64_t t = 0; t < (raster.num_rows() + 3) / 4; ++t) {
      tiles.push_back(grid->new_accumulator());
    }
    parallel_for(std::ssize(tiles), [&](std::int64_t t) {
      for (std::int64_t row = 4 * t; row < std::min(4 * t + 4, raster.num_rows()); ++row) {
        const auto f = forces(row);
        std::array<const float*, kDim> pointers;
        for (int a = 0; a < kDim; ++a) pointers[a] = f[a].data();
        grid->add_row(*tiles[static_cast<std::size_t>(t)], row, pointers);
      }
    });
    ControlPoints<kDim> gradient = ControlPoints<kDim>::Zero(kDim, phi.cols());
    grid->finish(tiles, gradient);
    return gradient;
  }
};

using Kinds =
    ::testing::Types<Kind<2, 1, true>, Kind<2, 2, true>, Kind<2, 3, true>, Kind<2, 4, true>,
                     Kind<2, 5, true>, Kind<3, 1, true>, Kind<3, 3, true>, Kind<2, 3, false>,
                     Kind<3, 2, false>, PowellSabinKind<false>, PowellSabinKind<true>,
                     Nurbs<2, 3, false>, Nurbs<2, 3, true>, Nurbs<3, 2, true>, NurbsTables<2>,
                     TSpline, ThinPlates<2, false>, ThinPlates<3, false>, ThinPlates<2, true>,
                     ThinPlates<3, true>>;
TYPED_TEST_SUITE(BoundGridSuite, Kinds);

TYPED_TEST(BoundGridSuite, CoversTheSamplesOfTheDomain) {
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(this->raster.size[0]));
  int covered = 0;
  for (std::int64_t row = 0; row < this->raster.num_rows(); ++row) {
    const auto [begin, end] = this->grid->row_range(row);
    this->grid->coverage(row, inside);
    for (int i = 0; i < this->raster.size[0]; ++i) {
      const bool expected = this->basis->contains(this->sample(row, i));
      EXPECT_EQ(inside[i] == 1, expected);
      if (expected) EXPECT_TRUE(i >= begin && i < end);
      covered += expected;
    }
  }
  EXPECT_GT(covered, 0);
  EXPECT_EQ(covered < this->raster.num_samples(), !TypeParam::kEverywhere);
}

TYPED_TEST(BoundGridSuite, MapsAsTheBasisDoes) {
  const auto coefficients = this->grid->prepare(this->phi);
  for (std::int64_t row = 0; row < this->raster.num_rows(); ++row) {
    auto out = this->buffers(77);
    std::array<float*, TypeParam::kDim> pointers;
    for (int a = 0; a < TypeParam::kDim; ++a) pointers[a] = out[a].data();
    this->grid->map_row(*coefficients, row, pointers);
    const auto [begin, end] = this->grid->row_range(row);
    for (int i = begin; i < end; ++i) {
      const auto b = this->basis->evaluate(this->sample(row, i));
      const Vector<TypeParam::kDim> u = this->phi(Eigen::all, b.control_points) * b.values;
      for (int a = 0; a < TypeParam::kDim; ++a) ASSERT_NEAR(out[a][i], u[a], this->kMapError);
    }
    for (int i = 0; i < begin; ++i) EXPECT_EQ(out[0][i], 77);
  }
}

// <B c, g> = <c, B^T g>, with the left side summed from the rows in double precision: what single
// precision loses in the terms (1e-7 each) averages out.
TYPED_TEST(BoundGridSuite, AdjointIsTheTransposedMap) {
  const auto coefficients = this->grid->prepare(this->phi);
  double left = 0, size = 0;
  for (std::int64_t row = 0; row < this->raster.num_rows(); ++row) {
    auto out = this->buffers(0);
    const auto f = this->forces(row);
    std::array<float*, TypeParam::kDim> pointers;
    for (int a = 0; a < TypeParam::kDim; ++a) pointers[a] = out[a].data();
    this->grid->map_row(*coefficients, row, pointers);
    const auto [begin, end] = this->grid->row_range(row);
    for (int a = 0; a < TypeParam::kDim; ++a) {
      for (int i = begin; i < end; ++i) {
        left += double(out[a][i]) * f[a][i];
        size += std::abs(double(out[a][i]) * f[a][i]);
      }
    }
  }
  EXPECT_NEAR(this->adjoint().cwiseProduct(this->phi).sum(), left, 1e-8 * size);
}

TYPED_TEST(BoundGridSuite, AdjointMatchesTheBasisPointByPoint) {
  ControlPoints<TypeParam::kDim> expected = 0 * this->phi;
  for (std::int64_t row = 0; row < this->raster.num_rows(); ++row) {
    const auto f = this->forces(row);
    const auto [begin, end] = this->grid->row_range(row);
    for (int i = begin; i < end; ++i) {
      const auto b = this->basis->evaluate(this->sample(row, i));
      for (std::size_t n = 0; n < b.control_points.size(); ++n) {
        for (int a = 0; a < TypeParam::kDim; ++a) {
          expected(a, b.control_points[n]) += b.values[n] * f[a][i];
        }
      }
    }
  }
  const double size = TypeParam::kOnLattice ? expected.cwiseAbs().maxCoeff() : 1;
  EXPECT_LT((this->adjoint() - expected).cwiseAbs().maxCoeff(), this->kMapError * size);
}

TYPED_TEST(BoundGridSuite, CurvatureIsTheSumOverBlocks) {
  if (TypeParam::kOnLattice) GTEST_SKIP() << "takes larger blocks";
  constexpr int kDim = TypeParam::kDim, kBlock = CurvatureBlocks<kDim>::kBlock;
  CurvatureBlocks<kDim> blocks(this->raster.size);
  testing::Numbers numbers(9);
  for (auto& component : blocks.sums) {
    for (float& g : component) g = static_cast<float>(numbers());
  }
  const auto pattern =
      std::make_shared<HessianPattern>(this->basis->num_control_points(), this->basis->couplings());
  BlockHessian<kDim> hessian(pattern), expected(pattern);
  this->grid->add_curvature(blocks, 0.5, hessian);

  // Every block by itself: the covered sample nearest to the block's middle one.
  Eigen::Matrix<int, kDim, 1> num;
  for (int a = 0; a < kDim; ++a) num[a] = blocks.blocks[a];
  for (int b = 0; b < num.prod(); ++b) {
    Vector<kDim> low, high;
    for (int a = 0, rest = b; a < kDim; rest /= num[a], ++a) {
      low[a] = rest % num[a] * kBlock;
      high[a] = std::min(low[a] + kBlock, double(this->raster.size[a]));
    }
    Point<kDim> best = Point<kDim>::Zero();
    double distance = 1e300;
    for (std::int64_t row = 0; row < this->raster.num_rows(); ++row) {
      for (int i = static_cast<int>(low[0]); i < static_cast<int>(high[0]); ++i) {
        Vector<kDim> index;
        index[0] = i;
        index[1] = static_cast<double>(kDim == 2 ? row : row % this->raster.size[1]);
        if constexpr (kDim == 3) {
          const std::int64_t plane = row / this->raster.size[1];
          index[2] = static_cast<double>(plane);
        }
        if ((index.array() < low.array()).any() || (index.array() >= high.array()).any()) continue;
        const Point<kDim> x = this->raster.point(index);
        constexpr int kMiddle = kBlock / 2;
        const double d = (index - low - Vector<kDim>::Constant(kMiddle)).norm();
        if (d < distance && this->basis->contains(x)) {
          distance = d;
          best = x;
        }
      }
    }
    if (distance == 1e300) continue;
    Matrix<kDim> g;
    for (int a = 0, s = 0; a < kDim; ++a) {
      for (int c = a; c < kDim; ++c, ++s) g(a, c) = g(c, a) = 0.5 * blocks.sums[s][b];
    }
    const auto basis = this->basis->evaluate(best);
    for (std::size_t n = 0; n < basis.control_points.size(); ++n) {
      for (std::size_t m = 0; m <= n; ++m) {
        expected.add(basis.control_points[n], basis.control_points[m],
                     basis.values[n] * basis.values[m] * g);
      }
    }
  }
  EXPECT_LT((hessian.to_sparse() - expected.to_sparse()).norm(),
            1e-6 * expected.to_sparse().norm());
}

TYPED_TEST(BoundGridSuite, SameBytesOnAnyNumberOfThreads) {
  constexpr int kDim = TypeParam::kDim;
  CurvatureBlocks<kDim> blocks(this->raster.size);
  for (auto& component : blocks.sums) std::ranges::fill(component, 0.37f);
  const auto pattern =
      std::make_shared<HessianPattern>(this->basis->num_control_points(), this->basis->couplings());
  const auto run = [&] {
    BlockHessian<kDim> hessian(pattern);
    this->grid->add_curvature(blocks, 1.3, hessian);
    return std::pair(this->adjoint(), Eigen::VectorXd(hessian.to_sparse().coeffs()));
  };
  set_num_threads(1);
  const auto one = run();
  for (int threads : {2, 8}) {
    set_num_threads(threads);
    const auto many = run();
    EXPECT_EQ(one.first, many.first);
    EXPECT_EQ(one.second, many.second);
  }
  set_num_threads(0);
}

// One curvature everywhere: the larger blocks' middles stand for all samples.
template <int Dim>
void expect_gathered_curvature() {
  const auto basis = ThinPlates<Dim, true>::make();
  const auto raster = raster_over<Dim>(testing::small_lattice<Dim>());
  const auto grid = ThinPlates<Dim, true>::bind(*basis, raster);
  CurvatureBlocks<Dim> blocks(raster.size);
  for (std::size_t s = 0; s < blocks.sums.size(); ++s) {
    std::ranges::fill(blocks.sums[s], static_cast<float>(1 + s));
  }
  const CurvaturePoints<Dim> points(raster, ThinPlates<Dim, true>::kStep);
  BlockHessian<Dim> hessian(basis->pattern()), expected(basis->pattern());
  grid->add_curvature(blocks, 0.5, hessian);
  double gathered = 0;
  for (Eigen::Index q = 0; q < points.points().cols(); ++q) {
    gathered += points.sums(blocks, 0)[q];
    const auto at = basis->evaluate(points.points().col(q));
    for (std::size_t i = 0; i < at.control_points.size(); ++i) {
      for (std::size_t k = 0; k <= i; ++k) {
        Matrix<Dim> g;
        for (int a = 0, s = 0; a < Dim; ++a) {
          for (int c = a; c < Dim; ++c, ++s) {
            g(a, c) = g(c, a) = 0.5 * points.sums(blocks, s)[q];
          }
        }
        expected.add(at.control_points[i], at.control_points[k], at.values[i] * at.values[k] * g);
      }
    }
  }
  EXPECT_EQ(gathered, static_cast<double>(blocks.sums[0].size()));
  EXPECT_LT(points.points().cols(), std::ssize(blocks.sums[0]));
  EXPECT_LT((hessian.to_sparse() - expected.to_sparse()).norm(),
            1e-10 * expected.to_sparse().norm());
}

TEST(LatticeGrid, GathersCurvatureInLargerBlocks) {
  expect_gathered_curvature<2>();
  expect_gathered_curvature<3>();
}

TEST(LatticeGrid, RefusesMoreThanFourGigabytes) {
  Raster<3> raster;
  raster.size.fill(128);
  const auto none = [](const ControlPoints<3>& x) { return Eigen::MatrixXd(0, x.cols()); };
  EXPECT_THAT([&] { LatticeGrid<3>(none, 512, raster, 1.2, 20.0); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("fewer centres")));
}

TEST(TensorBSplineGrid, IsChosenForAlignedRastersOnly) {
  const auto basis = testing::small_basis<2>();
  auto raster = raster_over<2>(basis->lattice());
  EXPECT_NE(dynamic_cast<TensorBSplineGrid<2>*>(basis->bind(raster).get()), nullptr);
  raster.direction = testing::turned<2>(0.31);
  EXPECT_NE(dynamic_cast<SparseRowGrid<2>*>(basis->bind(raster).get()), nullptr);
  EXPECT_THROW(TensorBSplineGrid<2>(basis->lattice(), 3, raster), InvalidInput);
}

TEST(TensorBSplineGrid, IsChosenForNurbsToo) {
  const NurbsBasis<2> basis(testing::rational_net<2>(testing::small_lattice<2>(), 3));
  auto raster = raster_over<2>(testing::small_lattice<2>());
  EXPECT_NE(dynamic_cast<TensorBSplineGrid<2>*>(basis.bind(raster).get()), nullptr);
  raster.direction = testing::turned<2>(0.31);
  EXPECT_NE(dynamic_cast<SparseRowGrid<2>*>(basis.bind(raster).get()), nullptr);
}

TEST(TensorBSplineGrid, CoversNothingOfARasterElsewhere) {
  const auto basis = testing::small_basis<2>();
  auto raster = raster_over<2>(basis->lattice());
  raster.origin += Point<2>(1000, 0);
  const auto grid = basis->bind(raster);
  for (std::int64_t row = 0; row < raster.num_rows(); ++row) {
    const auto [begin, end] = grid->row_range(row);
    EXPECT_EQ(begin, end);
  }
  BlockHessian<2> hessian(
      std::make_shared<HessianPattern>(basis->num_control_points(), basis->couplings()));
  grid->add_curvature(CurvatureBlocks<2>(raster.size), 1.0, hessian);
  EXPECT_EQ(hessian.to_sparse().norm(), 0);
}

// The vectorised kernels of both instruction sets agree up to the order of additions.
TEST(TensorBSplineKernels, AgreeOnBothInstructionSets) {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) GTEST_SKIP();
#endif
  const std::vector<TensorRun> runs = {{3, 8, 0}, {8, 29, 1}, {29, 33, 2}};
  std::vector<float> local(64), force(64), first(64), second(64);
  testing::Numbers numbers;
  for (auto* row : {&local, &force}) {
    for (float& v : *row) v = static_cast<float>(0.5 * numbers());
  }
  const Eigen::MatrixXd polynomials = numbers.columns<4>(4);
  const Eigen::VectorXd net = numbers.columns<1>(6).transpose();
  const TensorRowPlan plan{3, 6, runs.data(), 3, local.data(), polynomials.data(), 0};
  const double* rows[] = {net.data()};
  const double weights[] = {0.7};
  std::vector<double> sums(6);
  baseline::tensor_map_row(plan, rows, weights, 1, sums.data(), first.data());
  avx2::tensor_map_row(plan, rows, weights, 1, sums.data(), second.data());
  for (int i = 3; i < 33; ++i) EXPECT_NEAR(first[i], second[i], 1e-6);

  Eigen::VectorXd a = Eigen::VectorXd::Zero(6), b = a;
  double* targets[] = {a.data()};
  baseline::tensor_adjoint_row(plan, force.data(), targets, weights, 1, sums.data());
  targets[0] = b.data();
  avx2::tensor_adjoint_row(plan, force.data(), targets, weights, 1, sums.data());
  EXPECT_LT((a - b).norm(), 1e-5);
  EXPECT_GT(a.norm(), 0.1);
}

}  // namespace crease

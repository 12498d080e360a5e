// The tensor-product B-spline: point by point against ITK's, and whole rasters on one thread.
#include <benchmark/benchmark.h>

#include <Eigen/Eigenvalues>  // before ITK, which else brings its own, older one
#include <random>

#include "Core/Parallel.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "itkBSplineTransform.h"

namespace {

using namespace crease;

template <int Dim>
Raster<Dim> raster_of(int size) {
  Raster<Dim> raster;
  raster.size.fill(size);
  return raster;
}

template <int Dim>
std::shared_ptr<const TensorBSplineBasis<Dim>> basis_over(const Raster<Dim>& raster, int spans) {
  return std::make_shared<TensorBSplineBasis<Dim>>(
      covering_lattice(raster, static_cast<double>(raster.size[0]) / spans));
}

template <int Dim>
ControlPoints<Dim> random_control_points(const SplineBasis<Dim>& basis) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-3, 3);
  return ControlPoints<Dim>::NullaryExpr(Dim, basis.num_control_points(),
                                         [&] { return uniform(engine); });
}

template <int Dim>
std::vector<Point<Dim>> scattered_points(int size) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(1, size - 2);
  std::vector<Point<Dim>> points(1024);
  for (auto& p : points) {
    for (double& c : p) c = uniform(engine);
  }
  return points;
}

template <int Dim>
void BM_PointCrease(benchmark::State& state) {
  const auto basis = basis_over(raster_of<Dim>(128), 16);
  SplineTransform<Dim> transform(basis);
  transform.set_control_points(random_control_points(*basis));
  const auto points = scattered_points<Dim>(128);
  for (auto _ : state) {
    for (const auto& p : points) benchmark::DoNotOptimize(transform.map(p));
  }
  state.SetItemsProcessed(state.iterations() * std::ssize(points));
}
BENCHMARK(BM_PointCrease<2>);
BENCHMARK(BM_PointCrease<3>);

template <int Dim>
void BM_PointItk(benchmark::State& state) {
  const auto basis = basis_over(raster_of<Dim>(128), 16);
  const ControlPoints<Dim> phi = random_control_points(*basis);
  using Itk = itk::BSplineTransform<double, Dim, 3>;
  const auto transform = Itk::New();
  typename Itk::OriginType origin;
  typename Itk::PhysicalDimensionsType extent;
  typename Itk::MeshSizeType mesh;
  for (int a = 0; a < Dim; ++a) {
    origin[a] = basis->lattice().origin[a];
    mesh[a] = static_cast<unsigned>(basis->lattice().spans[a]);
    extent[a] = basis->lattice().spacing[a] * basis->lattice().spans[a];
  }
  transform->SetTransformDomainOrigin(origin);
  transform->SetTransformDomainPhysicalDimensions(extent);
  transform->SetTransformDomainMeshSize(mesh);
  typename Itk::ParametersType parameters(transform->GetNumberOfParameters());
  for (int a = 0; a < Dim; ++a) {
    for (Eigen::Index i = 0; i < phi.cols(); ++i) parameters[a * phi.cols() + i] = phi(a, i);
  }
  transform->SetParameters(parameters);
  const auto points = scattered_points<Dim>(128);
  SplineTransform<Dim> ours(basis);
  ours.set_control_points(phi);
  double worst = 0;
  for (const auto& p : points) {
    const auto q = transform->TransformPoint(itk::Point<double, Dim>(p.data()));
    worst = std::max(worst, (ours.map(p) - Point<Dim>(q.GetDataPointer())).norm());
  }
  state.counters["largest_difference_mm"] = worst;
  for (auto _ : state) {
    for (const auto& p : points) {
      benchmark::DoNotOptimize(transform->TransformPoint(itk::Point<double, Dim>(p.data())));
    }
  }
  state.SetItemsProcessed(state.iterations() * std::ssize(points));
}
BENCHMARK(BM_PointItk<2>);
BENCHMARK(BM_PointItk<3>);

/// Arguments: samples per side, spans per side.
template <int Dim>
struct BoundCase {
  explicit BoundCase(const benchmark::State& state)
      : raster(raster_of<Dim>(static_cast<int>(state.range(0)))),
        basis(basis_over(raster, static_cast<int>(state.range(1)))),
        grid(basis->bind(raster)) {
    for (auto& row : rows) row.assign(padded_row_size(raster), 0.5f);
  }
  std::array<float*, Dim> pointers() {
    std::array<float*, Dim> p;
    for (int a = 0; a < Dim; ++a) p[a] = rows[a].data();
    return p;
  }
  std::array<const float*, Dim> const_pointers() {
    std::array<const float*, Dim> p;
    for (int a = 0; a < Dim; ++a) p[a] = rows[a].data();
    return p;
  }
  Raster<Dim> raster;
  std::shared_ptr<const TensorBSplineBasis<Dim>> basis;
  std::unique_ptr<BoundGrid<Dim>> grid;
  std::array<std::vector<float>, Dim> rows;
};

template <int Dim>
void BM_Bind(benchmark::State& state) {
  BoundCase<Dim> setup(state);
  for (auto _ : state) benchmark::DoNotOptimize(setup.basis->bind(setup.raster));
  state.SetItemsProcessed(state.iterations() * setup.raster.num_samples());
}
BENCHMARK(BM_Bind<2>)->Args({512, 22});

template <int Dim>
void BM_RasterMap(benchmark::State& state) {
  BoundCase<Dim> setup(state);
  const auto phi = random_control_points<Dim>(*setup.basis);
  for (auto _ : state) {
    const auto coefficients = setup.grid->prepare(phi);
    for (std::int64_t row = 0; row < setup.raster.num_rows(); ++row) {
      setup.grid->map_row(*coefficients, row, setup.pointers());
    }
    benchmark::DoNotOptimize(setup.rows);
  }
  state.SetItemsProcessed(state.iterations() * setup.raster.num_samples());
}
BENCHMARK(BM_RasterMap<2>)->Args({512, 22})->Args({512, 64})->Args({2048, 40});
BENCHMARK(BM_RasterMap<3>)->Args({128, 12});

template <int Dim>
void BM_RasterAdjoint(benchmark::State& state) {
  BoundCase<Dim> setup(state);
  ControlPoints<Dim> gradient = ControlPoints<Dim>::Zero(Dim, setup.basis->num_control_points());
  constexpr int kTile = 16;
  for (auto _ : state) {
    std::vector<std::unique_ptr<typename BoundGrid<Dim>::Accumulator>> sums;
    for (std::int64_t row = 0; row < setup.raster.num_rows(); ++row) {
      if (row % kTile == 0) sums.push_back(setup.grid->new_accumulator());
      setup.grid->add_row(*sums.back(), row, setup.const_pointers());
    }
    setup.grid->finish(sums, gradient);
  }
  benchmark::DoNotOptimize(gradient);
  state.SetItemsProcessed(state.iterations() * setup.raster.num_samples());
}
BENCHMARK(BM_RasterAdjoint<2>)->Args({512, 22})->Args({512, 64})->Args({2048, 40});
BENCHMARK(BM_RasterAdjoint<3>)->Args({128, 12});

template <int Dim>
void BM_Curvature(benchmark::State& state) {
  BoundCase<Dim> setup(state);
  CurvatureBlocks<Dim> blocks(setup.raster.size);
  for (auto& component : blocks.sums) std::fill(component.begin(), component.end(), 0.3f);
  BlockHessian<Dim> hessian(std::make_shared<HessianPattern>(setup.basis->num_control_points(),
                                                             setup.basis->couplings()));
  set_num_threads(1);
  for (auto _ : state) setup.grid->add_curvature(blocks, 1.0, hessian);
  set_num_threads(0);
  state.SetItemsProcessed(state.iterations() * std::ssize(blocks.sums[0]));
}
BENCHMARK(BM_Curvature<2>)->Args({512, 22})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Curvature<3>)->Args({128, 12})->Unit(benchmark::kMillisecond);

template <int Dim>
void BM_HessianToSparse(benchmark::State& state) {
  BoundCase<Dim> setup(state);
  BlockHessian<Dim> hessian(std::make_shared<HessianPattern>(setup.basis->num_control_points(),
                                                             setup.basis->couplings()));
  for (auto _ : state) benchmark::DoNotOptimize(hessian.to_sparse());
}
BENCHMARK(BM_HessianToSparse<2>)->Args({512, 22})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_HessianToSparse<3>)->Args({128, 12})->Unit(benchmark::kMillisecond);

}  // namespace

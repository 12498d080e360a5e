// The tensor-product cubic B-spline: at scattered points and on rasters, next to ITK's. One thread.
#include <benchmark/benchmark.h>

#include <Eigen/Eigenvalues>  // before ITK, which else brings its own, older one

#include "Testing/Benchmarks/Counters.h"
#include "Testing/Benchmarks/Samples.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/SplineTransform.h"
#include "itkBSplineTransform.h"

namespace crease::benchmarks {
namespace {

template <int Dim>
using ItkSpline = itk::BSplineTransform<double, Dim, 3>;

/// 16 spans per axis over 128^Dim samples.
template <int Dim>
struct PointCase {
  PointCase() {
    std::array<int, Dim> size;
    size.fill(128);
    raster = raster_of<Dim>(size);
    basis = tensor_basis(raster, 16);
    phi = random_control_points(*basis);
    points = scattered_points(raster);
  }
  Threads one_thread;
  Raster<Dim> raster;
  std::shared_ptr<const TensorBSplineBasis<Dim>> basis;
  ControlPoints<Dim> phi;
  std::vector<Point<Dim>> points;
};

template <int Dim>
typename ItkSpline<Dim>::Pointer to_itk(const TensorBSplineBasis<Dim>& basis,
                                        const ControlPoints<Dim>& phi) {
  using Itk = ItkSpline<Dim>;
  const auto transform = Itk::New();
  typename Itk::OriginType origin;
  typename Itk::PhysicalDimensionsType extent;
  typename Itk::MeshSizeType mesh;
  for (int a = 0; a < Dim; ++a) {
    origin[a] = basis.lattice().origin[a];
    mesh[a] = static_cast<unsigned>(basis.lattice().spans[a]);
    extent[a] = basis.lattice().spacing[a] * basis.lattice().spans[a];
  }
  transform->SetTransformDomainOrigin(origin);
  transform->SetTransformDomainPhysicalDimensions(extent);
  transform->SetTransformDomainMeshSize(mesh);
  typename Itk::ParametersType parameters(transform->GetNumberOfParameters());
  for (int a = 0; a < Dim; ++a) {
    for (Eigen::Index i = 0; i < phi.cols(); ++i) parameters[a * phi.cols() + i] = phi(a, i);
  }
  transform->SetParameters(parameters);
  return transform;
}

template <int Dim>
itk::Point<double, Dim> itk_point(const Point<Dim>& x) {
  return itk::Point<double, Dim>(x.data());
}

/// The values and numbers of the functions that do not vanish.
template <int Dim>
void BM_TensorPointBasis(benchmark::State& state) {
  const PointCase<Dim> setup;
  for (auto _ : state) {
    for (const auto& p : setup.points) benchmark::DoNotOptimize(setup.basis->evaluate(p));
  }
  count_time(state, "per_point", std::ssize(setup.points));
}
BENCHMARK(BM_TensorPointBasis<2>);
BENCHMARK(BM_TensorPointBasis<3>);

/// The same by ITK, which maps the point as well.
template <int Dim>
void BM_ItkPointBasis(benchmark::State& state) {
  const PointCase<Dim> setup;
  const auto transform = to_itk(*setup.basis, setup.phi);
  const auto count = transform->GetNumberOfWeights();
  typename ItkSpline<Dim>::WeightsType weights(count);
  typename ItkSpline<Dim>::ParameterIndexArrayType indices(count);
  itk::Point<double, Dim> mapped;
  bool inside = false;
  for (auto _ : state) {
    for (const auto& p : setup.points) {
      transform->TransformPoint(itk_point<Dim>(p), mapped, weights, indices, inside);
      benchmark::DoNotOptimize(weights);
    }
  }
  count_time(state, "per_point", std::ssize(setup.points));
}
BENCHMARK(BM_ItkPointBasis<2>);
BENCHMARK(BM_ItkPointBasis<3>);

template <int Dim>
void BM_TensorPointMap(benchmark::State& state) {
  const PointCase<Dim> setup;
  SplineTransform<Dim> transform(setup.basis);
  transform.set_control_points(setup.phi);
  for (auto _ : state) {
    for (const auto& p : setup.points) benchmark::DoNotOptimize(transform.map(p));
  }
  count_time(state, "per_point", std::ssize(setup.points));
}
BENCHMARK(BM_TensorPointMap<2>);
BENCHMARK(BM_TensorPointMap<3>);

template <int Dim>
void BM_ItkPointMap(benchmark::State& state) {
  const PointCase<Dim> setup;
  const auto transform = to_itk(*setup.basis, setup.phi);
  SplineTransform<Dim> ours(setup.basis);
  ours.set_control_points(setup.phi);
  double worst = 0;
  for (const auto& p : setup.points) {
    const auto q = transform->TransformPoint(itk_point<Dim>(p));
    worst = std::max(worst, (ours.map(p) - Point<Dim>(q.GetDataPointer())).norm());
  }
  state.counters["largest_difference_mm"] = worst;
  for (auto _ : state) {
    for (const auto& p : setup.points) {
      benchmark::DoNotOptimize(transform->TransformPoint(itk_point<Dim>(p)));
    }
  }
  count_time(state, "per_point", std::ssize(setup.points));
}
BENCHMARK(BM_ItkPointMap<2>);
BENCHMARK(BM_ItkPointMap<3>);

/// Arguments: samples per side, spans per side.
template <int Dim>
struct BoundCase {
  explicit BoundCase(const benchmark::State& state) {
    std::array<int, Dim> size;
    size.fill(static_cast<int>(state.range(0)));
    raster = raster_of<Dim>(size);
    basis = tensor_basis(raster, static_cast<int>(state.range(1)));
    grid = basis->bind(raster);
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
  void count(benchmark::State& state) const {
    count_time(state, "per_pixel", raster.num_samples());
  }
  Threads one_thread;
  Raster<Dim> raster;
  std::shared_ptr<const TensorBSplineBasis<Dim>> basis;
  std::unique_ptr<BoundGrid<Dim>> grid;
  std::array<std::vector<float>, Dim> rows;
};

void plane_sizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"width", "spans"})->Args({512, 22})->Args({512, 64})->Args({2048, 40});
  b->Unit(benchmark::kMillisecond);
}
void plane_size(benchmark::internal::Benchmark* b) {
  b->ArgNames({"width", "spans"})->Args({512, 22})->Unit(benchmark::kMillisecond);
}
void volume_size(benchmark::internal::Benchmark* b) {
  b->ArgNames({"width", "spans"})->Args({128, 12})->Unit(benchmark::kMillisecond);
}

template <int Dim>
void BM_TensorBind(benchmark::State& state) {
  BoundCase<Dim> setup(state);
  for (auto _ : state) benchmark::DoNotOptimize(setup.basis->bind(setup.raster));
  setup.count(state);
}
BENCHMARK(BM_TensorBind<2>)->Apply(plane_size);

template <int Dim>
void BM_TensorRasterMap(benchmark::State& state) {
  BoundCase<Dim> setup(state);
  const auto phi = random_control_points<Dim>(*setup.basis);
  for (auto _ : state) {
    const auto coefficients = setup.grid->prepare(phi);
    for (std::int64_t row = 0; row < setup.raster.num_rows(); ++row) {
      setup.grid->map_row(*coefficients, row, setup.pointers());
    }
    benchmark::DoNotOptimize(setup.rows);
  }
  setup.count(state);
}
BENCHMARK(BM_TensorRasterMap<2>)->Apply(plane_sizes);
BENCHMARK(BM_TensorRasterMap<3>)->Apply(volume_size);

/// ITK has no other way than point by point.
template <int Dim>
void BM_ItkRasterMap(benchmark::State& state) {
  const BoundCase<Dim> setup(state);
  const auto transform = to_itk(*setup.basis, random_control_points<Dim>(*setup.basis));
  const Vector<Dim> step = setup.raster.index_to_point().col(0);
  for (auto _ : state) {
    for (std::int64_t row = 0; row < setup.raster.num_rows(); ++row) {
      Point<Dim> x = setup.raster.row_start(row);
      for (int i = 0; i < setup.raster.size[0]; ++i, x += step) {
        benchmark::DoNotOptimize(transform->TransformPoint(itk_point<Dim>(x)));
      }
    }
  }
  setup.count(state);
}
BENCHMARK(BM_ItkRasterMap<2>)->Apply(plane_size);
BENCHMARK(BM_ItkRasterMap<3>)
    ->ArgNames({"width", "spans"})
    ->Args({64, 6})
    ->Unit(benchmark::kMillisecond);

template <int Dim>
void BM_TensorAdjoint(benchmark::State& state) {
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
  setup.count(state);
}
BENCHMARK(BM_TensorAdjoint<2>)->Apply(plane_sizes);
BENCHMARK(BM_TensorAdjoint<3>)->Apply(volume_size);

template <int Dim>
void BM_TensorCurvature(benchmark::State& state) {
  BoundCase<Dim> setup(state);
  CurvatureBlocks<Dim> blocks(setup.raster.size);
  for (auto& component : blocks.sums) std::fill(component.begin(), component.end(), 0.3f);
  BlockHessian<Dim> hessian(std::make_shared<HessianPattern>(setup.basis->num_control_points(),
                                                             setup.basis->couplings()));
  for (auto _ : state) setup.grid->add_curvature(blocks, 1.0, hessian);
  setup.count(state);
}
BENCHMARK(BM_TensorCurvature<2>)->Apply(plane_size);
BENCHMARK(BM_TensorCurvature<3>)->Apply(volume_size);

template <int Dim>
void BM_HessianToSparse(benchmark::State& state) {
  const BoundCase<Dim> setup(state);
  const BlockHessian<Dim> hessian(std::make_shared<HessianPattern>(
      setup.basis->num_control_points(), setup.basis->couplings()));
  for (auto _ : state) benchmark::DoNotOptimize(hessian.to_sparse());
  count_time(state, "per_block", hessian.pattern().num_entries());
}
BENCHMARK(BM_HessianToSparse<2>)->Apply(plane_size);
BENCHMARK(BM_HessianToSparse<3>)->Apply(volume_size);

}  // namespace
}  // namespace crease::benchmarks

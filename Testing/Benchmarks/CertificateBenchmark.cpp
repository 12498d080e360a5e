// Certificates of invertibility, and the energy against folds. All on one thread.
#include <benchmark/benchmark.h>

#include "Testing/Benchmarks/Counters.h"
#include "Testing/Benchmarks/Samples.h"
#include "Transforms/Energies/FoldingEnergy.h"
#include "Transforms/InvertibilityCertificate.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease::benchmarks {
namespace {

/// The control points of random maps; how far they move, in thousandths of the mean edge, is what counts: the
/// farther, the more patches need a closer look, until the map folds.
template <int Dim>
SplineTransform<Dim> random_map(const std::shared_ptr<const SplineBasis<Dim>>& basis,
                                const benchmark::State& state) {
  SplineTransform<Dim> map(basis);
  map.set_control_points(random_control_points<Dim>(
      *basis, 1e-3 * static_cast<double>(state.range(0)) * basis->mean_edge_length()));
  return map;
}

template <int Dim>
void certify(benchmark::State& state, const SplineTransform<Dim>& map) {
  InvertibilityCertificate<Dim> certificate;
  for (auto _ : state) benchmark::DoNotOptimize(certificate = certify_invertibility<Dim>(map));
  state.counters["certified"] = certificate.certified();
  state.counters["patches"] = certificate.num_patches;
  state.counters["examined"] = certificate.num_examined;
  state.counters["bound"] = certificate.lower_bound;
}

/// 882 triangles on 512 x 512 pixels, C2 cubics, knots in general position.
std::shared_ptr<const TriangularBSplineBasis<2>> triangles() {
  return std::make_shared<TriangularBSplineBasis<2>>(
      jittered_net(raster_of<2>({512, 512}), {21, 21}, 3, 0.3));
}

void BM_CertificateTriangles(benchmark::State& state) {
  const Threads one_thread;
  certify<2>(state, random_map<2>(triangles(), state));
}
BENCHMARK(BM_CertificateTriangles)->Arg(20)->Arg(60)->Arg(100)->Unit(benchmark::kMillisecond);

void BM_CertificateTensor2(benchmark::State& state) {
  const Threads one_thread;
  certify<2>(state, random_map<2>(tensor_basis(raster_of<2>({512, 512}), 22), state));
}
BENCHMARK(BM_CertificateTensor2)->Arg(50)->Arg(200)->Arg(400)->Unit(benchmark::kMillisecond);

void BM_CertificateTensor3(benchmark::State& state) {
  const Threads one_thread;
  certify<3>(state, random_map<3>(tensor_basis(raster_of<3>({128, 128, 128}), 32), state));
}
BENCHMARK(BM_CertificateTensor3)->Arg(50)->Arg(150)->Arg(300)->Unit(benchmark::kMillisecond);

/// On all triangles, where folds are few: second argument 0 value, 1 value and gradient, 2 with the Hessian.
void BM_FoldingEvaluate(benchmark::State& state) {
  const Threads one_thread;
  const auto basis = triangles();
  const auto map = random_map<2>(basis, state);
  const FoldingEnergy<2> energy(*basis);
  ControlPoints<2> gradient = 0 * map.control_points();
  BlockHessian<2> hessian(basis->pattern());
  for (auto _ : state) {
    benchmark::DoNotOptimize(energy.evaluate(map.control_points(), 1,
                                             state.range(1) > 0 ? &gradient : nullptr,
                                             state.range(1) > 1 ? &hessian : nullptr));
  }
  count_time(state, "per_patch", 882);
}
BENCHMARK(BM_FoldingEvaluate)->ArgsProduct({{150}, {0, 1, 2}})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace crease::benchmarks

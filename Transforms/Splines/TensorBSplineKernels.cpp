#include "Transforms/Splines/TensorBSplineKernels.h"

namespace crease::CREASE_ISA {
namespace {

constexpr int kLanes = 8;
typedef float Floats __attribute__((vector_size(4 * kLanes)));
typedef float Unaligned __attribute__((vector_size(4 * kLanes), aligned(4)));
typedef float Quad __attribute__((vector_size(16)));
typedef int Ints __attribute__((vector_size(4 * kLanes)));

Floats load(const float* p) { return *reinterpret_cast<const Unaligned*>(p); }
void store(float* p, Floats v) { *reinterpret_cast<Unaligned*>(p) = v; }

/// The first `count` lanes of v, zero in the others.
Floats first_lanes(Floats v, int count) {
  const Ints lane = {0, 1, 2, 3, 4, 5, 6, 7};
  return reinterpret_cast<Floats>(reinterpret_cast<Ints>(v) & (lane < count));
}

Quad add_halves(Floats v) {
  return __builtin_shufflevector(v, v, 0, 1, 2, 3) + __builtin_shufflevector(v, v, 4, 5, 6, 7);
}

/// (sum of a, sum of b, sum of c, sum of d).
Quad lane_sums(Quad a, Quad b, Quad c, Quad d) {
  const Quad ab =
      __builtin_shufflevector(a, b, 0, 4, 1, 5) + __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Quad cd =
      __builtin_shufflevector(c, d, 0, 4, 1, 5) + __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

template <int Degree>
void map_runs(const TensorRowPlan& plan, const double* sums, float* out) {
  for (int n = 0; n < plan.num_runs; ++n) {
    const TensorRun& run = plan.runs[n];
    const double* c = sums + run.span;
    const double* polynomials = plan.polynomials + run.span * plan.polynomials_per_span;
    Floats coefficient[Degree + 1];
    for (int t = 0; t <= Degree; ++t) {
      double sum = 0;
      for (int r = 0; r <= Degree; ++r) sum += polynomials[t * (Degree + 1) + r] * c[r];
      coefficient[t] = Floats{} + static_cast<float>(sum);
    }
    // The last vector reaches into the next run, which overwrites it.
    for (int i = run.begin; i < run.end; i += kLanes) {
      const Floats s = load(plan.local + i);
      Floats value = coefficient[Degree];
      for (int t = Degree - 1; t >= 0; --t) value = value * s + coefficient[t];
      store(out + i, value);
    }
  }
}

template <int Degree>
void adjoint_runs(const TensorRowPlan& plan, const float* force, double* sums) {
  for (int n = 0; n < plan.num_runs; ++n) {
    const TensorRun& run = plan.runs[n];
    Floats moment[8] = {};  // Degree + 1 are used
    for (int i = run.begin; i < run.end; i += kLanes) {
      const Floats s = load(plan.local + i);
      Floats f = load(force + i);
      if (run.end - i < kLanes) f = first_lanes(f, run.end - i);
      moment[0] += f;
      for (int t = 1; t <= Degree; ++t) {
        f *= s;
        moment[t] += f;
      }
    }
    float total[8] = {};
    for (int t = 0; t <= Degree; t += 4) {
      const Quad quad = lane_sums(add_halves(moment[t]), add_halves(moment[t + 1]),
                                  add_halves(moment[t + 2]), add_halves(moment[t + 3]));
      for (int k = 0; k < 4; ++k) total[t + k] = quad[k];
    }
    double* c = sums + run.span;
    const double* polynomials = plan.polynomials + run.span * plan.polynomials_per_span;
    for (int t = 0; t <= Degree; ++t) {
      for (int r = 0; r <= Degree; ++r) {
        c[r] += polynomials[t * (Degree + 1) + r] * static_cast<double>(total[t]);
      }
    }
  }
}

}  // namespace

void tensor_map_row(const TensorRowPlan& plan, const double* const* rows, const double* weights,
                    int num_rows, double* sums, float* out) {
  for (int x = 0; x < plan.net_size; ++x) sums[x] = weights[0] * rows[0][x];
  for (int j = 1; j < num_rows; ++j) {
    for (int x = 0; x < plan.net_size; ++x) sums[x] += weights[j] * rows[j][x];
  }
  switch (plan.degree) {
    case 1:
      return map_runs<1>(plan, sums, out);
    case 2:
      return map_runs<2>(plan, sums, out);
    case 3:
      return map_runs<3>(plan, sums, out);
    case 4:
      return map_runs<4>(plan, sums, out);
    default:
      return map_runs<5>(plan, sums, out);
  }
}

void tensor_adjoint_row(const TensorRowPlan& plan, const float* force, double* const* rows,
                        const double* weights, int num_rows, double* sums) {
  for (int x = 0; x < plan.net_size; ++x) sums[x] = 0;
  switch (plan.degree) {
    case 1:
      adjoint_runs<1>(plan, force, sums);
      break;
    case 2:
      adjoint_runs<2>(plan, force, sums);
      break;
    case 3:
      adjoint_runs<3>(plan, force, sums);
      break;
    case 4:
      adjoint_runs<4>(plan, force, sums);
      break;
    default:
      adjoint_runs<5>(plan, force, sums);
      break;
  }
  for (int j = 0; j < num_rows; ++j) {
    for (int x = 0; x < plan.net_size; ++x) rows[j][x] += weights[j] * sums[x];
  }
}

}  // namespace crease::CREASE_ISA

#include "Metrics/IntensityKernel.h"

#include "Metrics/QuadLanes.h"

namespace crease::CREASE_ISA {
namespace {

template <int Dim>
void forces(const SlopeRow& row, int begin, int end) {
  for (int a = 0; a < Dim; ++a) {
    const float* gradient = row.gradient[a];
    float* force = row.force[a];
    for (int i = begin; i < end; ++i) force[i] = row.slope[i] * gradient[i];
    if (row.mask_slope == nullptr) continue;
    const float* of_mask = row.mask_gradient[a];
    for (int i = begin; i < end; ++i) force[i] += row.mask_slope[i] * of_mask[i];
  }
}

template <int Dim>
void curvatures(const SlopeRow& row, int begin, int end) {
  int k = 0;
  for (int a = 0; a < Dim; ++a) {
    for (int b = a; b < Dim; ++b, ++k) {
      const auto product = [&](int i) {
        return load(row.curvature + i) * load(row.gradient[a] + i) * load(row.gradient[b] + i);
      };
      float* out = row.curvature_sum[k];
      int i = begin;
      for (; i + 16 <= end; i += 16) {
        const Quad sums =
            sums_of_lanes(product(i), product(i + 4), product(i + 8), product(i + 12));
        store(out + i / 4, load(out + i / 4) + sums);
      }
      for (; i < end; i += 4) {
        const Quad p = product(i);
        out[i / 4] += sums_of_lanes(p, p, p, p)[0];
      }
    }
  }
}

template <int Dim>
void carry(const SlopeRow& row) {
  const int begin = row.begin / 4 * 4, end = (row.end + 3) / 4 * 4;
  forces<Dim>(row, begin, end);
  if (row.curvature_sum[0] != nullptr) curvatures<Dim>(row, begin, end);
}

double sum(Double4 v) { return (v[0] + v[1]) + (v[2] + v[3]); }

}  // namespace

void carry_slopes(const SlopeRow& row, int dim) { dim == 2 ? carry<2>(row) : carry<3>(row); }

ProductSums product_sums(const float* weight, const float* a, const float* b, int count) {
  Double4 lanes[6] = {};
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    const Double4 w = doubles(load(weight + i));
    const Double4 x = doubles(load(a + i));
    const Double4 y = doubles(load(b + i));
    const Double4 wx = w * x, wy = w * y;
    lanes[0] += w;
    lanes[1] += wx;
    lanes[2] += wy;
    lanes[3] += wx * x;
    lanes[4] += wy * y;
    lanes[5] += wx * y;
  }
  ProductSums result;
  for (int k = 0; k < 6; ++k) result.values[k] = sum(lanes[k]);
  for (; i < count; ++i) {
    const double w = weight[i], x = a[i], y = b[i];
    const double products[6] = {w, w * x, w * y, w * x * x, w * y * y, w * x * y};
    for (int k = 0; k < 6; ++k) result.values[k] += products[k];
  }
  return result;
}

WeightSums weight_sums(const float* weight, const float* inside, int count) {
  Double4 all = {}, within = {};
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    const Quad w = load(weight + i);
    all += doubles(w);
    within += doubles(w * load(inside + i));
  }
  WeightSums result{sum(all), sum(within)};
  for (; i < count; ++i) {
    result.weight += weight[i];
    result.weight_inside += weight[i] * inside[i];
  }
  return result;
}

void correlation_slopes(const CorrelationRow& row) {
  for (int i = 0; i < row.count; ++i) {
    const float a = row.a[i] - row.mean_a, b = row.b[i] - row.mean_b;
    row.slope[i] = row.weight[i] * (row.by_a * a + row.by_b * b);
    row.curvature[i] = row.weight[i] * row.c;
  }
}

void add_scaled(const float* from, float factor, float* to, int count) {
  for (int i = 0; i < count; ++i) to[i] += factor * from[i];
}

}  // namespace crease::CREASE_ISA

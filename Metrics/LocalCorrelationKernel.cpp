#include "Metrics/LocalCorrelationKernel.h"

#include "Metrics/QuadLanes.h"

namespace crease::CREASE_ISA {
namespace {

using Long4 = long long __attribute__((vector_size(32)));

/// Four samples' numbers, one vector for each number.
struct FourNumbers {
  Quad number[4] = {};

  static FourNumbers read(const float* samples) {
    FourNumbers four;
    for (int n = 0; n < 4; ++n) four.number[n] = load(samples + 4 * n);
    transpose(four.number);
    return four;
  }
  void write(float* samples) {
    transpose(number);
    for (int n = 0; n < 4; ++n) store(samples + 4 * n, number[n]);
  }
};

/// E = 1 - s_ab^2 / (s_aa s_bb) and its derivatives of four windows, as correlate() squared; all 0 but E = 1
/// where there is no contrast.
struct FourCorrelations {
  FourCorrelations(const FourNumbers& of_fixed, const FourNumbers& of_moving, double least) {
    const Double4 w = doubles(of_fixed.number[0]);
    const Double4 a = doubles(of_fixed.number[1]), b = doubles(of_moving.number[0]);
    const Double4 per_weight = 1 / (w > 0 ? w : Double4{} + 1);
    mean_a = a * per_weight;
    mean_b = b * per_weight;
    const Double4 aa = doubles(of_fixed.number[2]) - a * mean_a;
    const Double4 bb = doubles(of_moving.number[1]) - b * mean_b;
    const Double4 ab = doubles(of_moving.number[2]) - a * mean_b;
    const Long4 contrast = (aa > 0) & (bb > least * w) & (w > 0);
    const Double4 per_product = contrast ? 1 / (contrast ? aa * bb : Double4{} + 1) : Double4{};
    const Double4 squared = ab * ab * per_product;
    value = 1 - squared;
    by_a = -2 * ab * per_product;
    by_b = 2 * squared * aa * per_product;
    by_aa = squared * bb * per_product;
  }
  Double4 value, mean_a, mean_b, by_a, by_b, by_aa;
};

/// 1 or 0 of four samples.
Double4 flags(const std::uint8_t* counts) {
  return Double4{static_cast<double>(counts[0] != 0), static_cast<double>(counts[1] != 0),
                 static_cast<double>(counts[2] != 0), static_cast<double>(counts[3] != 0)};
}

double sum(Double4 v) { return (v[0] + v[1]) + (v[2] + v[3]); }

}  // namespace

void window_products(const WindowedRow& row, float* of_fixed, float* of_moving) {
  for (int i = 0; i < row.count; i += 4) {
    const Quad w = load(row.weight + i);
    // What a sample without weight was mapped to does not matter, even if it is not a number.
    const Quad a = w != 0 ? load(row.a + i) : Quad{};
    if (of_fixed != nullptr) FourNumbers{{w, w * a, w * a * a, Quad{}}}.write(of_fixed + 4 * i);
    if (of_moving == nullptr) continue;
    const Quad b = w != 0 ? load(row.b + i) - row.shift : Quad{};
    FourNumbers{{w * b, w * b * b, w * a * b, Quad{}}}.write(of_moving + 4 * i);
  }
}

CorrelatedSums correlate_windows(const WindowedRow& row, const CorrelatedRow& sums) {
  Double4 values = {}, weights = {};
  for (int i = 0; i < row.count; i += 4) {
    const FourCorrelations c(FourNumbers::read(sums.of_fixed + 4 * i),
                             FourNumbers::read(sums.of_moving + 4 * i), sums.least_variance);
    const Double4 w = doubles(load(row.weight + i)) * flags(sums.counts + i);
    values += w * c.value;
    weights += w;
    const Double4 rest = c.by_a * c.mean_a + c.by_b * c.mean_b;
    FourNumbers{{singles(w * c.by_a), singles(w * c.by_b), singles(-w * rest), Quad{}}}.write(
        sums.by_moving + 4 * i);
    if (sums.by_weight == nullptr) continue;
    const Double4 of_a = -2 * c.by_aa * c.mean_a - c.by_a * c.mean_b;
    const Double4 of_one =
        c.by_aa * c.mean_a * c.mean_a + (0.5 * c.by_b * c.mean_b + c.by_a * c.mean_a) * c.mean_b;
    FourNumbers{{singles(w * c.by_aa), singles(w * of_a), singles(w * of_one), Quad{}}}.write(
        sums.by_weight + 4 * i);
    store(sums.value + i, singles(c.value));
  }
  return {sum(values), sum(weights)};
}

void windowed_slopes(const WindowedRow& row, const WindowedSlopes& out) {
  for (int i = 0; i < row.count; i += 4) {
    const FourNumbers by = FourNumbers::read(out.by_moving + 4 * i);
    const Quad w = load(row.weight + i) * out.per_weight;
    const Quad a = load(row.a + i), b = w != 0 ? load(row.b + i) - row.shift : Quad{};
    store(out.slope + i, w * (by.number[0] * a + by.number[1] * b + by.number[2]));
    store(out.curvature + i, w * by.number[1]);
  }
}

}  // namespace crease::CREASE_ISA

#include "Metrics/WindowSumsKernel.h"

#include "Metrics/QuadLanes.h"

namespace crease::CREASE_ISA {

void sum_along_row(const float* values, int count, int radius, float* sums) {
  const auto value = [&](int i) {
    return i >= 0 && i < count ? doubles(load(values + 4 * i)) : Double4{};
  };
  Double4 sum = {};
  for (int i = 0; i < radius; ++i) sum += value(i);
  const auto step = [&](int i, Double4 enter, Double4 leave) {
    sum += enter - leave;
    store(sums + 4 * i, singles(sum));
  };
  int i = 0;
  for (; i < count && i <= radius; ++i) step(i, value(i + radius), Double4{});
  for (; i + radius < count; ++i) {
    step(i, doubles(load(values + 4 * (i + radius))), doubles(load(values + 4 * (i - radius - 1))));
  }
  for (; i < count; ++i) step(i, value(i + radius), value(i - radius - 1));
}

void advance_sums(double* sums, const float* enter, const float* leave, int count, float* out) {
  for (int i = 0; i < count; i += 4) {
    Double4 sum;
    __builtin_memcpy(&sum, sums + i, sizeof sum);
    sum += doubles(load(enter + i)) - doubles(load(leave + i));
    __builtin_memcpy(sums + i, &sum, sizeof sum);
    store(out + i, singles(sum));
  }
}

}  // namespace crease::CREASE_ISA

#include "Images/WeightedSumKernel.h"

#include "Images/InterpolationLanes.h"

namespace crease::CREASE_ISA {

void weighted_sum(const float* const* lines, const float* weights, int count, int width,
                  float* out) {
  constexpr int kBlock = 4 * kLanes;
  int x = 0;
  for (; x + kBlock <= width; x += kBlock) {
    Floats sum[4] = {};
    for (int t = 0; t < count; ++t) {
      const float* line = lines[t] + x;
      for (int k = 0; k < 4; ++k) sum[k] += weights[t] * load(line + k * kLanes);
    }
    for (int k = 0; k < 4; ++k) store(out + x + k * kLanes, sum[k]);
  }
  for (; x < width; ++x) {
    float sum = 0;
    for (int t = 0; t < count; ++t) sum += weights[t] * lines[t][x];
    out[x] = sum;
  }
}

}  // namespace crease::CREASE_ISA

#pragma once

namespace crease {

/// out[x] = sum_t weights[t] * lines[t][x] for 0 <= x < width, added in the order of t.
using WeightedSumKernel = void(const float* const* lines, const float* weights, int count,
                               int width, float* out);

namespace baseline {
WeightedSumKernel weighted_sum;
}
namespace avx2 {
WeightedSumKernel weighted_sum;
}

}  // namespace crease

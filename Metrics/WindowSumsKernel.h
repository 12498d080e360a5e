#pragma once

namespace crease {

/// Sums of four numbers per sample over windows along a row; double precision within.
using SumAlongRowKernel = void(const float* values, int count, int radius, float* sums);
/// sums += enter - leave; out = sums. All have `count` entries, a multiple of four.
using AdvanceSumsKernel = void(double* sums, const float* enter, const float* leave, int count,
                               float* out);

namespace baseline {
SumAlongRowKernel sum_along_row;
AdvanceSumsKernel advance_sums;
}  // namespace baseline
namespace avx2 {
SumAlongRowKernel sum_along_row;
AdvanceSumsKernel advance_sums;
}  // namespace avx2

}  // namespace crease

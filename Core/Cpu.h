#pragma once

namespace crease {

/// Whether kernels compiled for AVX2 with FMA may run here. The environment variable
/// CREASE_BASELINE=1 turns them off (for tests and comparisons).
bool cpu_has_avx2();

}  // namespace crease

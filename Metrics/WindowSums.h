#pragma once

#include <array>
#include <span>

namespace crease {

/// Replaces each entry by the sum over the window of 2 radius + 1 entries a side about it; entries beyond
/// the array are 0. Running sums in double precision, the same bits on any number of threads.
/// @param size    entries along each axis, the first one running fastest; unused axes have 1.
/// @param stride  entries from one row to the next, >= size[0].
void sum_windows(std::span<float> values, const std::array<int, 3>& size, std::size_t stride,
                 int radius);

}  // namespace crease

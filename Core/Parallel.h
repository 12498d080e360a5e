#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

namespace crease {

/// Threads of the whole process from now on; 0 = as many as the machine grants.
void set_num_threads(int count);
int num_threads();

/// Calls body(i) for i = 0..count-1, each once, in any order and on any thread.
/// Each call should be worth some microseconds: group small work into tiles.
void parallel_for(std::int64_t count, const std::function<void(std::int64_t)>& body);

/// Sums over i = 0..count-1 with the same bits on any number of threads: blocks depend on `count`
/// only, each block adds in order into its own copy of `zero` by body(i, partial), and the blocks'
/// sums are added (`operator+=`) in order.
template <typename Sum, typename Body>
Sum parallel_sum(std::int64_t count, const Sum& zero, Body&& body, std::int64_t block_size = 4096) {
  const std::int64_t num_blocks = (count + block_size - 1) / block_size;
  std::vector<Sum> partial(static_cast<std::size_t>(num_blocks), zero);
  parallel_for(num_blocks, [&](std::int64_t b) {
    Sum sum = zero;
    const std::int64_t end = std::min(count, (b + 1) * block_size);
    for (std::int64_t i = b * block_size; i < end; ++i) body(i, sum);
    partial[static_cast<std::size_t>(b)] = std::move(sum);
  });
  Sum total = zero;
  for (const Sum& p : partial) total += p;
  return total;
}

}  // namespace crease

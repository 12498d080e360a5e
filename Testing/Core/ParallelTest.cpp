#include "Core/Parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

namespace crease {

TEST(Parallel, VisitsEveryIndexOnce) {
  std::vector<std::atomic<int>> visits(10007);
  parallel_for(std::ssize(visits), [&](std::int64_t i) { ++visits[static_cast<std::size_t>(i)]; });
  for (const auto& v : visits) EXPECT_EQ(v.load(), 1);
}

// Terms of very different size: any change in the order of additions changes the last bits.
TEST(Parallel, SumHasTheSameBitsOnAnyNumberOfThreads) {
  const auto sum = [] {
    return parallel_sum(100003, 0.0, [](std::int64_t i, double& s) {
      s += std::exp(std::sin(static_cast<double>(i)) * 20);
    });
  };
  set_num_threads(1);
  const double one = sum();
  for (int threads : {2, 3, 8}) {
    set_num_threads(threads);
    EXPECT_EQ(one, sum());
  }
  set_num_threads(0);
}

TEST(Parallel, SumOfNothingIsZero) {
  EXPECT_EQ(parallel_sum(0, 3.5, [](std::int64_t, double& s) { s += 1; }), 3.5);
}

}  // namespace crease

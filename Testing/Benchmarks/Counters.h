#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>

#include "Core/Parallel.h"

namespace crease::benchmarks {

/// The number of threads while the object lives.
class Threads {
 public:
  explicit Threads(int count = 1) : count_(count) { set_num_threads(count); }
  ~Threads() { set_num_threads(0); }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;
  int count() const { return count_; }

 private:
  int count_;
};

/// Sets the counter `name` to the time that one thread spends on an item (in seconds; it prints as 3.2ns)
/// when every iteration handles `items` of them on `threads` threads. With several threads the benchmark
/// must use real time.
inline void count_time(benchmark::State& state, const std::string& name, std::int64_t items,
                       int threads = 1) {
  state.counters[name] = benchmark::Counter(
      static_cast<double>(items) / threads,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

}  // namespace crease::benchmarks

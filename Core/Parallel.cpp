#include "Core/Parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <memory>
#include <mutex>

namespace crease {
namespace {
std::mutex limit_mutex;
std::unique_ptr<tbb::global_control> limit;  // lives as long as the limit shall hold
int limit_count = 0;
}  // namespace

void set_num_threads(int count) {
  const std::lock_guard lock(limit_mutex);
  limit.reset();
  limit_count = std::max(0, count);
  if (limit_count > 0) {
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(limit_count));
  }
}

int num_threads() {
  const std::lock_guard lock(limit_mutex);
  return limit_count > 0 ? limit_count : tbb::info::default_concurrency();
}

void parallel_for(std::int64_t count, const std::function<void(std::int64_t)>& body) {
  if (count == 1) {
    body(0);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, 1),
                    [&](const tbb::blocked_range<std::int64_t>& range) {
                      for (std::int64_t i = range.begin(); i < range.end(); ++i) body(i);
                    });
}

}  // namespace crease

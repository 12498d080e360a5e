#include "Applications/Resources.h"

#include <malloc.h>
#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <thread>

namespace crease {
namespace {

namespace fs = std::filesystem;

/// Numbers separated by blanks; "max" is infinite. Empty when the file is not as expected.
std::optional<double> read_number(std::istream& stream) {
  std::string word;
  if (!(stream >> word)) return std::nullopt;
  if (word == "max") return std::numeric_limits<double>::infinity();
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (*end != '\0') return std::nullopt;
  return value;
}

std::optional<double> read_number(const fs::path& file) {
  std::ifstream stream(file);
  return read_number(stream);
}

/// Cores per unit of time that one control group grants; infinite without a limit.
double quota_of(const fs::path& group) {
  double quota = -1, period = 0;
  if (std::ifstream v2(group / "cpu.max"); v2) {
    quota = read_number(v2).value_or(-1);
    period = read_number(v2).value_or(0);
  } else {
    quota = read_number(group / "cpu.cfs_quota_us").value_or(-1);
    period = read_number(group / "cpu.cfs_period_us").value_or(0);
  }
  return quota > 0 && period > 0 ? quota / period : std::numeric_limits<double>::infinity();
}

/// The smallest quota of the group and of those above it, up to the mount point.
double quota_up_to(const fs::path& mount, const fs::path& group) {
  double quota = quota_of(mount);
  fs::path here = mount;
  for (const fs::path& part : group.relative_path())
    quota = std::min(quota, quota_of(here /= part));
  return quota;
}

double cgroup_quota(const fs::path& root) {
  const fs::path mounts = root / "sys/fs/cgroup";
  double quota = std::min(quota_of(mounts), quota_of(mounts / "cpu"));
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {  // number:controllers:path
    const auto first = line.find(':');
    const auto second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const fs::path group = line.substr(second + 1);
    if (controllers.empty()) {
      quota = std::min(quota, quota_up_to(mounts, group));
    } else if (("," + controllers + ",").find(",cpu,") != std::string::npos) {
      quota = std::min(quota, quota_up_to(mounts / controllers, group));
      quota = std::min(quota, quota_up_to(mounts / "cpu", group));
    }
  }
  return quota;
}

/// A positive whole number at the start of the variable ("4", or "4,2" of nested levels).
std::optional<int> environment_count(const char* name) {
  const char* text = std::getenv(name);
  if (text == nullptr) return std::nullopt;
  const long value = std::strtol(text, nullptr, 10);
  if (value < 1 || value > 4096) return std::nullopt;
  return static_cast<int>(value);
}

int bound_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) return CPU_COUNT(&set);
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace

int granted_threads(const fs::path& root) {
  int count = bound_cores();
  const double quota = cgroup_quota(root);
  if (quota < count) count = static_cast<int>(std::ceil(quota));
  auto wish = environment_count("SLURM_CPUS_PER_TASK");
  if (!wish) wish = environment_count("OMP_NUM_THREADS");
  if (wish) count = std::min(count, *wish);
  return std::max(1, count);
}

void return_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024 / 1e6;
}

}  // namespace crease

#pragma once

#include <filesystem>

namespace crease {

/// Threads that this process may use: the smallest of the cores it is bound to, the cgroup's quota
/// (version 1 or 2, of its group and all groups above) and SLURM_CPUS_PER_TASK or else
/// OMP_NUM_THREADS; at least 1.
///
/// @param root  where /proc and /sys/fs/cgroup are found; another folder for tests.
int granted_threads(const std::filesystem::path& root = "/");

/// Gives back to the system what was freed: images of one stage leave gaps that those of the next may not fit.
void return_free_memory();

/// The largest memory that this process has held, in MB (10^6 bytes).
double peak_memory_mb();

}  // namespace crease

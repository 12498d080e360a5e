#include "Applications/Resources.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>

#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

/// Without the variables that the caller's batch system may have set.
class Resources : public ::testing::Test {
 protected:
  void SetUp() override {
    unsetenv("SLURM_CPUS_PER_TASK");
    unsetenv("OMP_NUM_THREADS");
  }
  void TearDown() override { SetUp(); }
  testing::TemporaryFolder root;
};

TEST_F(Resources, WithoutLimitsAllCoresAreGranted) {
  EXPECT_GE(granted_threads(root.path()), 1);
  EXPECT_LE(granted_threads(root.path()), static_cast<int>(std::thread::hardware_concurrency()));
}

TEST_F(Resources, ObeysTheControlGroupVersion2AndThoseAboveIt) {
  root.write("proc/self/cgroup", "0::/slice/job\n");
  root.write("sys/fs/cgroup/slice/cpu.max", "100000 100000\n");
  root.write("sys/fs/cgroup/slice/job/cpu.max", "max 100000\n");
  EXPECT_EQ(granted_threads(root.path()), 1);
  root.write("sys/fs/cgroup/slice/cpu.max", "50000 100000\n");  // half a core is one thread
  EXPECT_EQ(granted_threads(root.path()), 1);
}

TEST_F(Resources, ObeysTheControlGroupVersion1) {
  root.write("proc/self/cgroup", "5:memory:/job\n4:cpu,cpuacct:/job\n");
  root.write("sys/fs/cgroup/cpu,cpuacct/job/cpu.cfs_quota_us", "100000\n");
  root.write("sys/fs/cgroup/cpu,cpuacct/job/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(granted_threads(root.path()), 1);
  const int all = granted_threads((root / "nothing").string());
  root.write("sys/fs/cgroup/cpu,cpuacct/job/cpu.cfs_quota_us", "-1\n");  // no limit
  EXPECT_EQ(granted_threads(root.path()), all);
}

TEST_F(Resources, ObeysTheBatchSystemBeforeOpenMp) {
  setenv("OMP_NUM_THREADS", "1,4", 1);
  EXPECT_EQ(granted_threads(root.path()), 1);
  const int all = [&] {
    unsetenv("OMP_NUM_THREADS");
    return granted_threads(root.path());
  }();
  setenv("OMP_NUM_THREADS", "1", 1);
  setenv("SLURM_CPUS_PER_TASK", "4096", 1);
  EXPECT_EQ(granted_threads(root.path()), all);
  setenv("SLURM_CPUS_PER_TASK", "nonsense", 1);
  EXPECT_EQ(granted_threads(root.path()), 1);
}

TEST_F(Resources, MeasuresMemory) {
  EXPECT_GT(peak_memory_mb(), 1);
  EXPECT_LT(peak_memory_mb(), 1e6);
}

}  // namespace
}  // namespace crease

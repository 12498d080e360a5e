#pragma once

namespace crease {

/// While it lives, CHOLMOD, SPQR and their BLAS compute on the calling thread alone.
///
/// OpenBLAS (or BLIS, MKL) is set to one thread for the whole process, on first use and for good: its sums
/// change in the last bits with the number of threads. CHOLMOD's own OpenMP regions are switched off
/// for this thread and scope: they cover a few hundred numbers each, and waiting for their threads
/// doubles the time of a factorisation (ten times as much on a busy machine).
class SingleThreadedLibraries {
 public:
  SingleThreadedLibraries();
  ~SingleThreadedLibraries();
  SingleThreadedLibraries(const SingleThreadedLibraries&) = delete;
  SingleThreadedLibraries& operator=(const SingleThreadedLibraries&) = delete;

 private:
  int active_levels_ = 0;  // OpenMP's setting before
};

}  // namespace crease

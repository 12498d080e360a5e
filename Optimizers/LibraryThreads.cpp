#include "Optimizers/LibraryThreads.h"

#include <dlfcn.h>

#include <initializer_list>

namespace crease {
namespace {

// Found at run time: which BLAS there is, and whether CHOLMOD was built with OpenMP, is the system's
// choice.
struct Functions {
  int (*omp_get_max_active_levels)() = nullptr;
  void (*omp_set_max_active_levels)(int) = nullptr;

  Functions() {
    for (const char* name :
         {"openblas_set_num_threads", "bli_thread_set_num_threads", "MKL_Set_Num_Threads"}) {
      void (*set_num_threads)(int) = nullptr;
      if (find(name, set_num_threads)) set_num_threads(1);
    }
    if (!find("omp_get_max_active_levels", omp_get_max_active_levels) ||
        !find("omp_set_max_active_levels", omp_set_max_active_levels)) {
      omp_set_max_active_levels = nullptr;
    }
  }

  template <typename Function>
  static bool find(const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
    return function != nullptr;
  }
};

const Functions& functions() {
  static const Functions found;
  return found;
}

}  // namespace

SingleThreadedLibraries::SingleThreadedLibraries() {
  if (functions().omp_set_max_active_levels == nullptr) return;
  active_levels_ = functions().omp_get_max_active_levels();
  functions().omp_set_max_active_levels(0);
}

SingleThreadedLibraries::~SingleThreadedLibraries() {
  if (functions().omp_set_max_active_levels == nullptr) return;
  functions().omp_set_max_active_levels(active_levels_);
}

}  // namespace crease

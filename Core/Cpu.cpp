#include "Core/Cpu.h"

#include <cstdlib>
#include <string_view>

namespace crease {

bool cpu_has_avx2() {
#if defined(__x86_64__)
  static const bool yes = [] {
    const char* baseline = std::getenv("CREASE_BASELINE");
    if (baseline != nullptr && std::string_view(baseline) == "1") return false;
    return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  }();
  return yes;
#else
  return false;
#endif
}

}  // namespace crease

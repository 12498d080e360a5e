#include <iostream>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/BlockHessian.h"

int main() {
  const auto sum =
      crease::parallel_sum(5, 0, [](auto i, int& partial) { partial += static_cast<int>(i); });
  try {
    crease::HessianPattern(sum, {}).slot(3, 7);  // not in the pattern: an exception of the library
  } catch (const crease::InvalidInput&) {
    std::cout << "crease is installed\n";
  }
}

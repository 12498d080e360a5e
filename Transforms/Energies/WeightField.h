#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <string_view>

#include "Core/Error.h"
#include "Core/Point.h"

namespace crease {

/// How rigid the tissue at x (mm) is, 0 soft to 1 rigid; `region` is the body label of the patch that
/// holds x, -1 for bases without regions. Called from several threads at once.
template <int Dim>
using WeightField = std::function<double(const Point<Dim>& x, int region)>;

/// 1 in rigid bodies (regions above 0), 0 elsewhere.
template <int Dim>
WeightField<Dim> body_weights() {
  return [](const Point<Dim>&, int region) { return region > 0 ? 1.0 : 0.0; };
}

/// Watches the weights that an energy meets while it is built, from any thread.
class WeightRange {
 public:
  void add(double smallest, double largest) {
    const std::lock_guard lock(mutex_);
    smallest_ = std::min(smallest_, smallest);
    largest_ = std::max(largest_, largest);
    finite_ = finite_ && std::isfinite(smallest) && std::isfinite(largest);
  }
  /// @throws InvalidInput when a weight was outside [0, 1].
  void check(std::string_view energy) const {
    if (!finite_) throw InvalidInput(message(energy, ": the weight field is not a number."));
    if (smallest_ < 0 || largest_ > 1) {
      throw InvalidInput(message(energy, ": weights must lie in [0, 1]; found ", smallest_, " to ",
                                 largest_, "."));
    }
  }

 private:
  std::mutex mutex_;
  double smallest_ = 0, largest_ = 1;
  bool finite_ = true;
};

}  // namespace crease

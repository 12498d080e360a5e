#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <functional>
#include <limits>
#include <mutex>
#include <string_view>
#include <utility>

#include "Core/Error.h"
#include "Core/Point.h"

namespace crease {

/// How rigid the tissue at x (mm) is, 0 soft to 1 rigid; `region` is the body label of the patch that
/// holds x, -1 for bases without regions. Any callable w(x, region) is one; it is called from several
/// threads at once.
template <int Dim>
class WeightField {
 public:
  WeightField(std::nullptr_t = nullptr) {}  // NOLINT: no field
  template <std::invocable<const Point<Dim>&, int> F>
  WeightField(F weight) : weight_(std::move(weight)) {}  // NOLINT: a callable is a field
  /// A weight that depends on the region alone: what a body weighs need not be asked point by point.
  static WeightField by_region(const std::function<double(int region)>& weight) {
    WeightField field;
    field.weight_ = [weight](const Point<Dim>&, int region) { return weight(region); };
    field.of_region_ = weight;
    return field;
  }

  explicit operator bool() const { return weight_ != nullptr; }
  double operator()(const Point<Dim>& x, int region) const { return weight_(x, region); }
  /// Whether every point of the region is known to have this weight.
  bool is_constant(int region, double weight) const {
    return of_region_ && of_region_(region) == weight;
  }

 private:
  std::function<double(const Point<Dim>&, int)> weight_;
  std::function<double(int)> of_region_;
};

/// 1 in rigid bodies (regions above 0), 0 elsewhere.
template <int Dim>
WeightField<Dim> body_weights() {
  return WeightField<Dim>::by_region([](int region) { return region > 0 ? 1.0 : 0.0; });
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
  double smallest_ = std::numeric_limits<double>::infinity();
  double largest_ = -std::numeric_limits<double>::infinity();
  bool finite_ = true;
};

}  // namespace crease

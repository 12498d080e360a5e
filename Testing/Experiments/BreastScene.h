#pragma once

#include <cstdint>

#include "Registration/Phantoms/MammogramBody.h"
#include "Registration/Phantoms/MammogramTissue.h"
#include "Transforms/SplineTransform.h"

namespace crease::experiments {

/// A breast of the mammogram phantom with its true motion, that of an elastic body, and its greys.
class BreastScene {
 public:
  BreastScene(std::uint64_t seed, const MammogramBody& body);

  std::uint64_t seed() const { return seed_; }
  const MammogramDeformation& truth() const { return truth_; }
  /// Per cent of the squared differences between fixed breast and template that a map takes away. The template
  /// shows the fixed breast carried by the truth.
  double improvement(const SplineTransform<2>& map) const;

 private:
  double fixed_grey(const Point<2>& x) const;
  double template_grey(const Point<2>& y, const Point<2>& start) const;

  std::uint64_t seed_;
  MammogramDeformation truth_;
  MammogramTissue tissue_;
};

}  // namespace crease::experiments

#pragma once

#include <cstdint>

#include "Registration/Phantoms/Random.h"

namespace crease {

/// Uses of a mammogram phantom's seed (Random's streams).
enum class MammogramStream {
  kMotion = 101,
  kCoarseTexture,
  kFineTexture,
  kOtherCoarseTexture,  ///< of the other breast
  kOtherFineTexture,
  kDucts,
  kOtherDucts,  ///< which ducts the other breast does not share
  kMass,
  kDevelopment,  ///< gain and gamma of the moving image
  kFixedNoise,
  kMovingNoise,
  kBranches = 201,  ///< what grows from each of eight ducts
  kOtherBranches = 301
};

inline Random mammogram_random(std::uint64_t seed, MammogramStream stream, int member = 0) {
  return Random(seed, static_cast<std::uint64_t>(stream) + static_cast<std::uint64_t>(member));
}

}  // namespace crease

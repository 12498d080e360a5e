#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "Registration/Phantoms/MammogramPhantom.h"

namespace crease::testing {

/// Width of the mammogram phantom's frame, mm.
inline constexpr double kMammogramFrameMm = 204.8;

bool same_bytes(const auto& a, const auto& b) {
  return a.values().size() == b.values().size() &&
         (a.values().empty() || std::memcmp(a.values().data(), b.values().data(),
                                            a.values().size() * sizeof(a.values()[0])) == 0);
}

inline bool same_bytes(const MammogramImage& a, const MammogramImage& b) {
  return same_bytes(a.pixels, b.pixels) && same_bytes(a.mask, b.mask) &&
         same_bytes(a.labels, b.labels) && a.outline == b.outline && a.pectoral == b.pectoral;
}

inline bool same_bytes(const MammogramPhantom& a, const MammogramPhantom& b) {
  return same_bytes(a.fixed, b.fixed) && same_bytes(a.moving, b.moving) &&
         same_bytes(a.displacement, b.displacement) && a.landmarks.moving == b.landmarks.moving &&
         a.parameters == b.parameters;
}

/// A parameter by its name; fails when there is none.
inline double parameter(const MammogramPhantom& phantom, const std::string& name) {
  for (const auto& [key, value] : phantom.parameters) {
    if (key == name) return value;
  }
  ADD_FAILURE() << "no parameter " << name;
  return 0;
}

}  // namespace crease::testing

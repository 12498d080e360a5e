#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "Registration/Landmarks.h"
#include "Transforms/Transform.h"

namespace crease {

/// How far a map carries fixed landmarks from their partners, mm.
struct LandmarkErrors {
  std::vector<double> each;
  double largest = 0;
  double rms = 0;
};

template <int Dim>
LandmarkErrors landmark_errors(const Landmarks<Dim>& landmarks, const Transform<Dim>& transform) {
  LandmarkErrors errors;
  for (int j = 0; j < landmarks.size(); ++j) {
    const double error = (transform.map(landmarks.fixed[j]) - landmarks.moving[j]).norm();
    errors.each.push_back(error);
    errors.largest = std::max(errors.largest, error);
    errors.rms += error * error / landmarks.size();
  }
  errors.rms = std::sqrt(errors.rms);
  return errors;
}

}  // namespace crease

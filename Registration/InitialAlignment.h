#pragma once

#include <optional>
#include <string>

#include "Images/Image.h"
#include "Registration/Landmarks.h"
#include "Registration/Progress.h"
#include "Transforms/AffineMap.h"

namespace crease {

enum class AlignmentStart { kMoments, kCentres, kLandmarks, kIdentity };
enum class AlignmentSearch { kNone, kRigid, kAffine };

struct AlignmentOptions {
  AlignmentStart start = AlignmentStart::kMoments;
  AlignmentSearch search = AlignmentSearch::kNone;
  /// Also try the angles -30, -15, 15 and 30 degrees (2D) at the coarsest level.
  bool try_angles = true;
};

/// What the alignment did.
struct AlignmentReport {
  double metric_before = 0;  ///< mean squared difference at the start, normalised intensities
  double metric_after = 0;
  double angle_deg = 0;
  double shift_mm = 0;   ///< of the fixed mask's centroid
  bool improved = true;  ///< false: the search found nothing better and the start was kept
  int evaluations = 0;
};

template <int Dim>
struct Alignment {
  AffineMap<Dim> map;
  AlignmentReport report;
};

/// Finds the rigid or affine map A that the spline starts from: a start by moments, centres or
/// landmarks, then a search by the Nelder-Mead simplex on a pyramid (about 64 samples across at the
/// coarsest level), minimising the mean squared difference, then Gauss-Newton.
///
/// @param landmarks  may be empty; two (rigid) or three (affine) and more replace the start by their
///                   least-squares fit when the start asks for landmarks.
/// @throws InvalidInput when the images do not overlap after the start; the message names both boxes.
template <int Dim>
Alignment<Dim> align(const Image<float, Dim>& fixed, const Image<float, Dim>& moving,
                     const Mask<Dim>* fixed_mask, const Mask<Dim>* moving_mask,
                     const Landmarks<Dim>& landmarks, const AlignmentOptions& options,
                     const RegistrationCallback& progress = {});

extern template Alignment<2> align<2>(const Image<float, 2>&, const Image<float, 2>&,
                                      const Mask<2>*, const Mask<2>*, const Landmarks<2>&,
                                      const AlignmentOptions&, const RegistrationCallback&);
extern template Alignment<3> align<3>(const Image<float, 3>&, const Image<float, 3>&,
                                      const Mask<3>*, const Mask<3>*, const Landmarks<3>&,
                                      const AlignmentOptions&, const RegistrationCallback&);

}  // namespace crease

#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Optimizers/MakeOptimizer.h"
#include "Registration/Channel.h"
#include "Registration/Landmarks.h"
#include "Registration/MetricFactories.h"
#include "Registration/Progress.h"
#include "Transforms/AffineMap.h"

namespace crease {

/// A map that may be given.
template <int Dim>
using GivenMap = std::optional<AffineMap<Dim>>;

/// Where the search for A starts: centres of mass, of the images, a fit to landmarks, or the identity.
enum class AlignmentStart { kMoments, kCentres, kLandmarks, kIdentity };
/// Which maps are searched; none: the start is kept.
enum class AlignmentSearch { kNone, kRigid, kSimilarity, kAffine };

/// How A is found.
struct AlignmentOptions {
  AlignmentStart start = AlignmentStart::kMoments;
  AlignmentSearch search = AlignmentSearch::kNone;
  /// Also try the angles -30, -15, 15 and 30 degrees (2D) at the coarsest level.
  bool try_angles = true;
  /// What refines the map at every level.
  OptimizerKind optimizer = OptimizerKind::kGaussNewton;
};

/// What the alignment did.
struct AlignmentReport {
  double metric_before = 0;  ///< at the start, at full resolution
  double metric_after = 0;
  double angle_deg = 0;
  double shift_mm = 0;   ///< of the fixed mask's centroid
  bool improved = true;  ///< false: the search found nothing better and the start was kept
  int evaluations = 0;
  std::vector<ChannelReport> channels;  ///< of the metric, at full resolution
};

/// A, and how it was found.
template <int Dim>
struct Alignment {
  AffineMap<Dim> map;
  AlignmentReport report;
};

/// Finds the rigid, similar or affine map A that the spline starts from: a start by moments, centres or
/// landmarks, then a search by the Nelder-Mead simplex on a pyramid (about 64 samples across at the
/// coarsest level), then Gauss-Newton or another optimizer, by a metric that may be any.
///
/// @param channels   what is compared; the first makes the start. Intensities of several are normalised, so
///                   that their weights do not depend on units; those of one are taken as they are.
/// @param landmarks  may be empty; two (rigid, similarity) or three (affine) and more replace the start by their
///                   least-squares fit when the start asks for landmarks.
/// @param given      the start, in place of the one that the options name.
/// @throws InvalidInput when an image is constant in its mask, or when the images do not overlap after the
/// start; the message names the image, or both boxes.
template <int Dim>
Alignment<Dim> align(std::span<const ChannelView<Dim>> channels, const Landmarks<Dim>& landmarks,
                     const AlignmentOptions& options, const RegistrationCallback& progress = {},
                     const GivenMap<Dim>& given = std::nullopt);

/// The same for one pair of images.
template <int Dim>
Alignment<Dim> align(const Image<float, Dim>& fixed, const Image<float, Dim>& moving,
                     const Mask<Dim>* fixed_mask, const Mask<Dim>* moving_mask,
                     const Landmarks<Dim>& landmarks, const AlignmentOptions& options,
                     const RegistrationCallback& progress = {},
                     const std::optional<AffineMap<Dim>>& given = std::nullopt,
                     const MetricFactory<Dim>& metric = ssd<Dim>());

/// @throws InvalidInput when all pixels in the mask (null: all) have one value, or the mask is empty.
/// @param which  "fixed" or "moving", for the message.
template <int Dim>
void require_contrast(const Image<float, Dim>& image, const Mask<Dim>* mask,
                      const std::string& which);

/// @throws InvalidInput when the map carries the fixed image to a place where the moving one is not.
template <int Dim>
void require_overlap(const Raster<Dim>& fixed, const Raster<Dim>& moving,
                     const AffineMap<Dim>& map);

#define CREASE_DECLARE(Dim)                                                                     \
  extern template Alignment<Dim> align<Dim>(std::span<const ChannelView<Dim>>,                  \
                                            const Landmarks<Dim>&, const AlignmentOptions&,     \
                                            const RegistrationCallback&, const GivenMap<Dim>&); \
  extern template Alignment<Dim> align<Dim>(                                                    \
      const Image<float, Dim>&, const Image<float, Dim>&, const Mask<Dim>*, const Mask<Dim>*,   \
      const Landmarks<Dim>&, const AlignmentOptions&, const RegistrationCallback&,              \
      const GivenMap<Dim>&, const MetricFactory<Dim>&);                                         \
  extern template void require_contrast<Dim>(const Image<float, Dim>&, const Mask<Dim>*,        \
                                             const std::string&);                               \
  extern template void require_overlap<Dim>(const Raster<Dim>&, const Raster<Dim>&,             \
                                            const AffineMap<Dim>&);
CREASE_DECLARE(2)
CREASE_DECLARE(3)
#undef CREASE_DECLARE

}  // namespace crease

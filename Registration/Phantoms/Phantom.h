#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Images/Image.h"
#include "Registration/Landmarks.h"
#include "Transforms/Domains/FeatureLine.h"

namespace crease {

/// The true motion of one rigid body: x -> R (x - center) + center + shift.
struct PhantomBody {
  int label = 0;
  double angle_deg = 0;                ///< from the x to the y axis
  Point<2> center = Point<2>::Zero();  ///< in the fixed image, mm
  Vector<2> shift_mm = Vector<2>::Zero();
};

/// Two images and the map between them, known exactly: fixed(x) = moving(T(x)).
///
/// The moving image samples an analytic function m whose edges are blurred by a Gaussian, so that
/// it is band-limited; the fixed image samples m(T(x)). No map is inverted and nothing is
/// interpolated twice. All images share one raster: `size` pixels of 1 mm along every axis, the
/// first one's centre at the origin.
template <int Dim>
struct PhantomImages {
  std::string kind;
  Image<float, Dim> fixed;                             ///< intensities about 0 to 1
  Image<float, Dim> moving;                            ///< likewise
  std::function<Point<Dim>(const Point<Dim>&)> truth;  ///< T, fixed to moving, mm
  DisplacementField<Dim> displacement;                 ///< T(x) - x on the raster
  /// What was drawn and chosen, by name, for the phantom's description.
  std::vector<std::pair<std::string, double>> parameters;
};

/// In 2D there may be rigid bodies, too.
struct Phantom : PhantomImages<2> {
  LabelImage<2> labels;         ///< rigid bodies of the fixed image; empty for kinds without bodies
  LabelImage<2> moving_labels;  ///< the same bodies in the moving image
  std::vector<FeatureLine> feature_lines;  ///< outlines of the bodies, fixed image
  Landmarks<2> landmarks;
  std::vector<PhantomBody> bodies;
};

using VolumePhantom = PhantomImages<3>;

/// What is drawn.
struct PhantomOptions {
  int size = 0;            ///< pixels per axis, 64 to 4096 (3D: 16 to 512); 0: the kind's default
  std::uint64_t seed = 1;  ///< of texture and noise; other than 1: moves the bodies a little, too
  bool texture = true;     ///< soft tissue that shows structure; false: plain greys
  std::optional<double> noise =
      {};                        ///< deviation of the pixel noise, 0 to 0.5; default: the kind's
  double landmark_noise_mm = 0;  ///< deviation of each coordinate of the moving landmarks, >= 0
};

/// Names of the kinds: square, bodies, spine, blobs.
const std::vector<std::string>& phantom_kinds();

/// Makes a phantom. The same options give the same bytes on any number of threads.
/// @throws InvalidInput for an unknown kind or an option out of range, naming the range.
Phantom make_phantom(const std::string& kind, const PhantomOptions& options = {});

/// The volume of a kind, "blobs": 96 voxels per axis unless said otherwise.
/// @throws InvalidInput for a kind that has no volume or an option out of range.
VolumePhantom make_volume_phantom(const std::string& kind, const PhantomOptions& options = {});

/// Experiment 1: a square on its tip, turned by 45 degrees (other seeds: by 41 to 49) in a soft
/// frame whose corners stay. Default 400 pixels, no noise. 8 landmarks: the corners of the domain
/// and of the square.
Phantom make_square_phantom(const PhantomOptions& options);

/// Experiment 2: a square, a square on its tip and a triangle move on their own. Default 400
/// pixels, no noise. Other seeds: each turned by up to 2 degrees and shifted by up to 1/160 of the
/// width more. 13 landmarks on the outlines.
Phantom make_bodies_phantom(const PhantomOptions& options);

/// Experiment 3: five vertebrae with discs between them; the spine bends and stretches. Default 512
/// pixels, noise 0.01. Other seeds: each vertebra turned by up to 1 degree and shifted by up to
/// 1.5/512 of the width more. 20 landmarks: four corners of each vertebra.
Phantom make_spine_phantom(const PhantomOptions& options);

/// 40 soft blobs on texture under a smooth random warp of at most 4 % of the width: no bodies, no
/// landmarks. Default 256 pixels, no noise. In 3D the same with 160 blobs.
Phantom make_blobs_phantom(const PhantomOptions& options);
VolumePhantom make_blobs_volume_phantom(const PhantomOptions& options);

}  // namespace crease

#pragma once

#include <array>
#include <vector>

#include "Images/Image.h"
#include "Images/Interpolator.h"
#include "Transforms/AffineMap.h"

namespace crease {

/// A dense field of targets with the trust that each deserves, on a raster.
struct FlowField {
  Raster<2> raster;
  std::array<std::vector<float>, 2> displacement;  ///< target of x minus x, mm
  std::vector<float> weights;                      ///< 0 (no trust) to about 1
};

/// Dense optical flow from the fixed image to the moving image seen through A (DIS, OpenCV), as targets
/// of T(x). Trusted where the fixed image has structure and the flow explains the moving image:
///
///     w = m g2 / (g2 + 0.2 mean g2) * s2 / (s2 + r^2),   g2 = |grad fixed|^2, r = residual, s2 = mean r^2
///
/// with the mask m. A start for images of one modality: it finds motions that are too large for the
/// metric's gradient. Runs on one thread, so the bytes do not depend on the number of threads.
/// Source: T. Kroeger et al., "Fast Optical Flow using Dense Inverse Search", ECCV 2016.
///
/// @param fixed   at the resolution the flow shall have (at most about 1200 pixels wide).
/// @param mask    one weight per pixel of fixed.
FlowField optical_flow(const Image<float, 2>& fixed, const std::vector<float>& mask,
                       const Interpolator<2>& moving, const AffineMap<2>& affine);

}  // namespace crease

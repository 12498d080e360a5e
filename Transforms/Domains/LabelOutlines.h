#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "Core/Raster.h"
#include "Transforms/Domains/FeatureLine.h"

namespace crease {

/// How outlines are smoothed and sampled; lengths as said.
struct LabelOutlineOptions {
  /// Edge length of the mesh to be made, mm: sets the smallest gap; 0: not known.
  double edge_length = 0;
  /// Whether the outlines are sampled to that edge length; else they keep a point per pixel, and the mesher
  /// samples them.
  bool sampled = false;
  double tolerance = 0;          ///< mm that sampled outlines may run off; 0: half a pixel
  double image_smoothing = 1;    ///< sigma of the Gaussian over each body's indicator, pixels
  double contour_smoothing = 4;  ///< sigma along the border, pixels; more where it is straight
  int smallest_body = 12;        ///< pixels; smaller islands and holes are left out, with a warning
  double smallest_gap = -1;      ///< mm; nearer bodies share a border; -1: a quarter of edge_length
};

/// The outlines, and what was left out.
struct LabelOutlines {
  std::vector<FeatureLine> lines;
  std::vector<std::string> warnings;
};

/// Turns a label image (0 soft, k > 0 rigid body k) into feature lines along the borders of the bodies.
///
/// Each body's indicator is smoothed, its border taken where it equals that of its neighbour, at the
/// level that keeps the body's area, and smoothed along its length without shrinking it.
/// Lines run with the body on their left: outlines counter-clockwise, holes clockwise. Where two bodies
/// touch, both share one open line without a body side, which knows both labels. Bodies at the image's border
/// go on outside it for 20 pixels: the region of interest cuts their outlines off.
///
/// Accuracy on discs and rounded rectangles: 0.3 pixel before sampling, area to 1 %.
///
/// @throws InvalidInput when the sizes differ, a label is negative, or no label is above 0.
LabelOutlines label_outlines(const Raster<2>& raster, std::span<const std::int32_t> labels,
                             const LabelOutlineOptions& options = {});

}  // namespace crease

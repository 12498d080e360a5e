#pragma once

#include <memory>
#include <vector>

#include "Metrics/Metric.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/Energies/WeightField.h"
#include "Transforms/SplineTransform.h"

namespace crease {

/// A disc (ball) in which patches of half the size would pay.
template <int Dim>
struct FinerPlace {
  Point<Dim> centre = Point<Dim>::Zero();
  double radius = 0;       ///< mm
  double edge_length = 0;  ///< wanted there, mm: half of what the patches have
  double gain = 0;         ///< by which the cost is expected to fall
};

/// What is known at the minimum of a registration's finest level.
template <int Dim>
struct MinimumReached {
  const SplineTransform<Dim>& transform;
  std::shared_ptr<const BoundGrid<Dim>> grid;  ///< of the transform's basis
  std::shared_ptr<Metric<Dim>> metric;
  double image_weight = 1;  ///< alpha in the metric's unit
  double bending_weight = 0;
  WeightField<Dim> rigid;    ///< of the bending energy; null: soft everywhere
  double noise_density = 0;  ///< of the cost: what a squared normal deviate stands for, halved
};

/// Where the residual force asks for finer patches. A motion that the patches are too coarse for leaves
/// forces behind that no control point feels. Cubic B-splines, half as far from each other as the control
/// points are, are laid over the domain as probes: each feels the force g = alpha g_I + gamma g_S and has the curvature H, so that the
/// cost would fall by g^T H^-1 g / 2 or more. Noise alone gives Dim/2 times its density; places where several times
/// as much is to be gained are significant, and of these the best are taken, which hold most of the gain
/// (Doerfler 1996). Rigid bodies are left out: there are no finer motions in them.
///
/// Cost: one pass over the image per size of patches, and one over the quadrature of the bending energy.
/// @return the best first.
template <int Dim>
std::vector<FinerPlace<Dim>> finer_places(const MinimumReached<Dim>& minimum);

extern template std::vector<FinerPlace<2>> finer_places<2>(const MinimumReached<2>&);
extern template std::vector<FinerPlace<3>> finer_places<3>(const MinimumReached<3>&);

}  // namespace crease

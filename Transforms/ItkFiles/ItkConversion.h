#pragma once

#include <memory>

#include "Transforms/ItkFiles/ItkTransform.h"
#include "Transforms/Transform.h"

namespace crease {

/// What a list of ITK's transforms is to crease, told by names alone: "rigid", "affine", "spline",
/// "displacement field" or "composite", and its dimension, 2 or 3.
/// @throws FileError for a class that crease has no equal of, another dimension, or several transforms that
/// are no composite.
struct ItkSummary {
  std::string type;
  int dimension = 0;
};
ItkSummary summary_of(const ItkTransformList& list);

/// The same map in crease's classes:
///
///     affine and rigid classes        RigidTransform, AffineTransform (ItkLinear.h)
///     BSplineTransform,
///     BSplineDeformableTransform      SplineTransform on a TensorBSplineBasis of degree 1 to 3
///     DisplacementFieldTransform      DisplacementFieldTransform
///     CompositeTransform              CompositeTransform; ITK applies the last of its list first
///
/// In float or double. A spline is the same within its domain; outside, where ITK leaves points as they are,
/// crease's continues (SplineTransform.h).
/// @throws FileError as above, and when a transform's numbers are too few, too many, not finite or contradict
/// each other; names file, place in the list and class.
template <int Dim>
std::unique_ptr<Transform<Dim>> from_itk(const ItkTransformList& list);

}  // namespace crease

#pragma once

#include <memory>
#include <string_view>

#include "Transforms/ItkFiles/ItkTransform.h"
#include "Transforms/Transform.h"

namespace crease {

/// Whether ITK's class, such as "Euler3DTransform", is an affine map in this dimension.
template <int Dim>
bool is_itk_linear(std::string_view class_name);

/// Whether that class is a rotation and a shift alone, unless its numbers say otherwise.
template <int Dim>
bool is_itk_rigid(std::string_view class_name);

/// The same map as a RigidTransform or an AffineTransform about ITK's centre.
///
/// Source: SetParameters and ComputeMatrix of ITK 5.2's classes.
/// @throws InvalidInput when the numbers are too few or too many, not finite, or no versor.
template <int Dim>
std::unique_ptr<Transform<Dim>> itk_linear(std::string_view class_name,
                                           const ItkTransform& transform);

}  // namespace crease

#pragma once

#include <optional>

#include "Transforms/AffineMap.h"
#include "Transforms/Transform.h"

namespace crease {

/// The affine map that a transform is: of the affine, similarity and rigid classes, and of chains of them (the
/// identity for a chain of no parts). Empty for every other class, whatever its parameters.
template <int Dim>
std::optional<AffineMap<Dim>> affine_equivalent(const Transform<Dim>& transform);

}  // namespace crease

#pragma once

#include <memory>

#include "Transforms/JsonReader.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// A spline basis as part of a transform file. Entry "kind" is "tensor", "triangular", "nurbs", "thin-plate" or,
/// in the plane, "powell-sabin" or "tspline".
/// @throws InvalidInput when the basis is of no kind that files hold.
template <int Dim>
nlohmann::json basis_to_json(const SplineBasis<Dim>& basis);

/// @throws FileError naming the entry that is missing or wrong; InvalidInput when the basis refuses it.
template <int Dim>
std::shared_ptr<const SplineBasis<Dim>> basis_from_json(const JsonReader& reader);

}  // namespace crease

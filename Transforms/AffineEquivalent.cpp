#include "Transforms/AffineEquivalent.h"

#include "Transforms/AffineTransform.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SimilarityTransform.h"

namespace crease {

template <int Dim>
std::optional<AffineMap<Dim>> affine_equivalent(const Transform<Dim>& transform) {
  if (const auto* affine = dynamic_cast<const AffineTransform<Dim>*>(&transform)) {
    return affine->affine_map();
  }
  if (const auto* rigid = dynamic_cast<const RigidTransform<Dim>*>(&transform)) {
    return rigid->affine_map();
  }
  if (const auto* similarity = dynamic_cast<const SimilarityTransform<Dim>*>(&transform)) {
    return similarity->affine_map();
  }
  const auto* chain = dynamic_cast<const CompositeTransform<Dim>*>(&transform);
  if (chain == nullptr) return std::nullopt;
  AffineMap<Dim> whole;
  for (std::size_t k = 0; k < chain->num_parts(); ++k) {
    const auto part = affine_equivalent(chain->part(k));
    if (!part) return std::nullopt;
    whole = {part->linear * whole.linear, (*part)(whole.offset)};
  }
  return whole;
}

template std::optional<AffineMap<2>> affine_equivalent(const Transform<2>&);
template std::optional<AffineMap<3>> affine_equivalent(const Transform<3>&);

}  // namespace crease

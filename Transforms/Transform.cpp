#include "Transforms/Transform.h"

#include "Transforms/TransformSampler.h"

namespace crease {

template <int InDim, int OutDim>
std::unique_ptr<TransformSampler<InDim, OutDim>> Transform<InDim, OutDim>::sampler() const {
  return std::make_unique<OneByOneSampler<InDim, OutDim>>(*this);
}

template class Transform<2, 2>;
template class Transform<3, 3>;
template class Transform<2, 3>;

}  // namespace crease

#pragma once

#include <memory>
#include <optional>

#include "Images/Image.h"
#include "Transforms/BoundGrid.h"
#include "Transforms/SplineTransform.h"

namespace crease {

/// How much nearer to the fixed image R a warped moving image is than the moving image T itself:
///
///     ( |T - R|^2 - |T_* - R|^2 ) / |T - R|^2,     T_*(x) = T(T_n(..T_1(x))),
///
/// sums over the samples of a domain, images as they are, T interpolated by cubic B-splines and beyond its
/// border continued.
/// Source: dissertation, table 4.2.
class ImageImprovement {
 public:
  /// @param grid  of the domain's basis, bound to the fixed image's raster.
  /// @param mask  null: all samples of the domain.
  ImageImprovement(Image<float, 2> fixed, const Image<float, 2>& moving, const Mask<2>* mask,
                   std::shared_ptr<const BoundGrid<2>> grid);
  ~ImageImprovement();

  /// In per cent, negative where the images are farther apart than before; nullopt: they were equal before.
  /// @param deformation  of the grid's basis.
  /// @param refinement   of the grid's basis, applied first; null: none.
  std::optional<double> percent(const SplineTransform<2>& deformation,
                                const SplineTransform<2>* refinement = nullptr) const;
  /// Whether the images were equal before, but for rounding.
  bool equal() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace crease

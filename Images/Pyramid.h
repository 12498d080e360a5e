#pragma once

#include <array>
#include <vector>

#include "Images/Image.h"

namespace crease {

/// Finer pixels per coarse pixel along each axis: powers of two. Coarse pixel i covers the finer pixels
/// f i .. f i + f - 1. Write `ShrinkFactors<2>{2, 2}`.
template <int Dim>
struct ShrinkFactors : std::array<int, Dim> {};

/// The factors of a pyramid's level, level 0 being the raster itself. From level to level an axis is
/// halved unless its spacing is already 1.5 times the smallest or it has fewer than 16 pixels.
template <int Dim>
ShrinkFactors<Dim> shrink_factors(const Raster<Dim>& raster, int level);

/// How many levels lead down to about `smallest` pixels along the longest axis; at least 1.
template <int Dim>
int num_pyramid_levels(const Raster<Dim>& raster, int smallest = 64);

/// The raster of coarse pixels: ceil(n / f) of them, their centres in the middle of what they cover. The
/// last one reaches beyond the border where f does not divide n.
template <int Dim>
Raster<Dim> shrink(const Raster<Dim>& raster, const ShrinkFactors<Dim>& factors);

/// Halves repeatedly with the kernel [1 3 3 1]/8 per axis, outer pixels repeated beyond the border.
/// @throws InvalidInput when a factor is not a power of two.
template <int Dim>
Image<float, Dim> shrink(const Image<float, Dim>& image, const ShrinkFactors<Dim>& factors);

/// 1 where more than half of the finer pixels that a coarse one covers are not zero.
template <int Dim>
Mask<Dim> shrink_mask(const Mask<Dim>& mask, const ShrinkFactors<Dim>& factors);

/// The label that most of the covered pixels have, the smallest of several.
template <int Dim>
LabelImage<Dim> shrink_labels(const LabelImage<Dim>& labels, const ShrinkFactors<Dim>& factors);

/// The image and its coarser versions, finest first. @throws InvalidInput when levels < 1.
template <int Dim>
std::vector<Image<float, Dim>> make_pyramid(const Image<float, Dim>& image, int levels);

extern template ShrinkFactors<2> shrink_factors<2>(const Raster<2>&, int);
extern template ShrinkFactors<3> shrink_factors<3>(const Raster<3>&, int);
extern template int num_pyramid_levels<2>(const Raster<2>&, int);
extern template int num_pyramid_levels<3>(const Raster<3>&, int);
extern template Raster<2> shrink<2>(const Raster<2>&, const ShrinkFactors<2>&);
extern template Raster<3> shrink<3>(const Raster<3>&, const ShrinkFactors<3>&);
extern template Image<float, 2> shrink<2>(const Image<float, 2>&, const ShrinkFactors<2>&);
extern template Image<float, 3> shrink<3>(const Image<float, 3>&, const ShrinkFactors<3>&);
extern template Mask<2> shrink_mask<2>(const Mask<2>&, const ShrinkFactors<2>&);
extern template Mask<3> shrink_mask<3>(const Mask<3>&, const ShrinkFactors<3>&);
extern template LabelImage<2> shrink_labels<2>(const LabelImage<2>&, const ShrinkFactors<2>&);
extern template LabelImage<3> shrink_labels<3>(const LabelImage<3>&, const ShrinkFactors<3>&);
extern template std::vector<Image<float, 2>> make_pyramid<2>(const Image<float, 2>&, int);
extern template std::vector<Image<float, 3>> make_pyramid<3>(const Image<float, 3>&, int);

}  // namespace crease

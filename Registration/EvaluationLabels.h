#pragma once

#include <vector>

#include "Images/Image.h"
#include "Registration/Evaluation.h"

namespace crease {

/// Distance in mm from every sample to the nearest one of the set (0 in it; infinite for an empty
/// set). Exact, linear in the number of samples. Source: Felzenszwalb and Huttenlocher, "Distance
/// Transforms of Sampled Functions", Theory of Computing 8, 2012.
template <int Dim>
Image<float, Dim> distance_to(const Mask<Dim>& set);

/// Samples with a face neighbour of another label.
template <int Dim>
Mask<Dim> border_samples(const LabelImage<Dim>& labels);

/// Dice coefficient and 95 % Hausdorff distance of each label above 0 of either image, ascending.
/// Both images lie on one raster.
template <int Dim>
std::vector<LabelOverlap> compare_labels(const LabelImage<Dim>& a, const LabelImage<Dim>& b);

extern template Image<float, 2> distance_to<2>(const Mask<2>&);
extern template Image<float, 3> distance_to<3>(const Mask<3>&);
extern template Mask<2> border_samples<2>(const LabelImage<2>&);
extern template Mask<3> border_samples<3>(const LabelImage<3>&);
extern template std::vector<LabelOverlap> compare_labels<2>(const LabelImage<2>&,
                                                            const LabelImage<2>&);
extern template std::vector<LabelOverlap> compare_labels<3>(const LabelImage<3>&,
                                                            const LabelImage<3>&);

}  // namespace crease

#pragma once

#include <vector>

#include "Images/Image.h"

namespace crease {

/// A sample that stands out.
template <int Dim>
struct Extreme {
  Point<Dim> at = Point<Dim>::Zero();  ///< mm
  double value = 0;
};

/// The smallest (or largest) finite values in the mask, the first first, each a twelfth of the image's
/// longest side or more away from those before. @param count  at most as many.
template <int Dim>
std::vector<Extreme<Dim>> extremes(const Image<float, Dim>& image, const Mask<Dim>& mask,
                                   bool largest, int count);

extern template std::vector<Extreme<2>> extremes<2>(const Image<float, 2>&, const Mask<2>&, bool,
                                                    int);
extern template std::vector<Extreme<3>> extremes<3>(const Image<float, 3>&, const Mask<3>&, bool,
                                                    int);

}  // namespace crease

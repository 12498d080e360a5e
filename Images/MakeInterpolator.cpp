#include "Images/MakeInterpolator.h"

#include "Images/CubicBSplineInterpolator.h"
#include "Images/LinearInterpolator.h"

namespace crease {

template <int Dim>
std::unique_ptr<Interpolator<Dim>> make_interpolator(const Image<float, Dim>& image,
                                                     InterpolationKind kind) {
  if (kind == InterpolationKind::kLinear) return std::make_unique<LinearInterpolator<Dim>>(image);
  return std::make_unique<CubicBSplineInterpolator<Dim>>(image);
}

template std::unique_ptr<Interpolator<2>> make_interpolator<2>(const Image<float, 2>&,
                                                               InterpolationKind);
template std::unique_ptr<Interpolator<3>> make_interpolator<3>(const Image<float, 3>&,
                                                               InterpolationKind);

}  // namespace crease

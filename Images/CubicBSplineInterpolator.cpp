#include "Images/CubicBSplineInterpolator.h"

#include <limits>

#include "Core/Cpu.h"
#include "Images/BSplinePrefilter.h"
#include "Images/InterpolatorDetail.h"

namespace crease {
namespace {

constexpr int kLast = 1;   // the neighbours of the last pixel are in the padding
constexpr int kReach = 2;  // pixels away that a value within a pixel depends on

std::array<double, 4> weights(double t) {
  const double s = 1 - t;
  return {s * s * s / 6, 2.0 / 3 + t * t * (t / 2 - 1), 2.0 / 3 + s * s * (s / 2 - 1),
          t * t * t / 6};
}

std::array<double, 4> derivatives(double t) {
  const double s = 1 - t;
  return {-s * s / 2, t * (1.5 * t - 2), s * (2 - 1.5 * s), t * t / 2};
}

}  // namespace

template <int Dim>
CubicBSplineInterpolator<Dim>::CubicBSplineInterpolator(const Image<float, Dim>& image)
    : raster_(image.raster()), coefficients_(cubic_bspline_coefficients(image)) {}

template <int Dim>
auto CubicBSplineInterpolator<Dim>::evaluate(const Point<Dim>& x) const -> Sample {
  const detail::PixelPosition<Dim> p(raster_, x, kLast);
  if (!p.finite) return {.value = std::numeric_limits<double>::quiet_NaN()};
  std::array<std::array<double, 4>, Dim> w, d;
  const float* corner = coefficients_.data();
  for (int a = 0; a < Dim; ++a) {
    w[a] = weights(p.fraction[a]);
    d[a] = derivatives(p.fraction[a]);
    corner += (std::int64_t{p.whole[a]} - 1) * coefficients_.stride()[a];
  }
  Sample sample;
  Vector<Dim> gradient = Vector<Dim>::Zero();
  detail::sum_taps<Dim, 4>(corner, coefficients_.stride(), w, d, sample.value, gradient);
  sample.inside = p.inside;
  if (p.inside) sample.gradient = raster_.point_to_index().transpose() * gradient;
  return sample;
}

template <int Dim>
void CubicBSplineInterpolator<Dim>::evaluate_row(const MappedRow<Dim>& row, float* value,
                                                 const std::array<float*, Dim>& gradient,
                                                 float* inside) const {
  const auto kernel_row =
      detail::kernel_row<Dim>(raster_, coefficients_, row, value, gradient, inside);
  if constexpr (Dim == 2) {
    cpu_has_avx2() ? avx2::cubic_row_2(kernel_row) : baseline::cubic_row_2(kernel_row);
  } else {
    cpu_has_avx2() ? avx2::cubic_row_3(kernel_row) : baseline::cubic_row_3(kernel_row);
  }
}

template <int Dim>
IntensityRange CubicBSplineInterpolator<Dim>::coefficient_range() const {
  return coefficients_.range(nullptr, kReach);
}

template <int Dim>
IntensityRange CubicBSplineInterpolator<Dim>::coefficient_range(const Mask<Dim>& mask) const {
  return coefficients_.range(&mask, kReach);
}

template class CubicBSplineInterpolator<2>;
template class CubicBSplineInterpolator<3>;

}  // namespace crease

#include "Images/LinearInterpolator.h"

#include <limits>

#include "Core/Cpu.h"
#include "Images/InterpolatorDetail.h"

namespace crease {
namespace {

constexpr int kLast = 2;   // the last cell begins at the pixel before the last
constexpr int kReach = 1;  // pixels away that a value within a pixel depends on

}  // namespace

template <int Dim>
LinearInterpolator<Dim>::LinearInterpolator(const Image<float, Dim>& image)
    : raster_(image.raster()), pixels_(image) {}

template <int Dim>
auto LinearInterpolator<Dim>::evaluate(const Point<Dim>& x) const -> Sample {
  const detail::PixelPosition<Dim> p(raster_, x, kLast);
  if (!p.finite) return {.value = std::numeric_limits<double>::quiet_NaN()};
  std::array<std::array<double, 2>, Dim> w, d;
  const float* corner = pixels_.data();
  for (int a = 0; a < Dim; ++a) {
    w[a] = {1 - p.fraction[a], p.fraction[a]};
    d[a] = p.free[a] ? std::array{-1.0, 1.0} : std::array{0.0, 0.0};
    corner += std::int64_t{p.whole[a]} * pixels_.stride()[a];
  }
  Sample sample;
  Vector<Dim> gradient = Vector<Dim>::Zero();
  detail::sum_taps<Dim, 2>(corner, pixels_.stride(), w, d, sample.value, gradient);
  sample.inside = p.inside;
  if (p.inside) sample.gradient = raster_.point_to_index().transpose() * gradient;
  return sample;
}

template <int Dim>
void LinearInterpolator<Dim>::evaluate_row(const MappedRow<Dim>& row, float* value,
                                           const std::array<float*, Dim>& gradient,
                                           float* inside) const {
  const auto kernel_row = detail::kernel_row<Dim>(raster_, pixels_, row, value, gradient, inside);
  if constexpr (Dim == 2) {
    cpu_has_avx2() ? avx2::linear_row_2(kernel_row) : baseline::linear_row_2(kernel_row);
  } else {
    cpu_has_avx2() ? avx2::linear_row_3(kernel_row) : baseline::linear_row_3(kernel_row);
  }
}

template <int Dim>
IntensityRange LinearInterpolator<Dim>::coefficient_range() const {
  return pixels_.range(nullptr, kReach);
}

template <int Dim>
IntensityRange LinearInterpolator<Dim>::coefficient_range(const Mask<Dim>& mask) const {
  return pixels_.range(&mask, kReach);
}

template class LinearInterpolator<2>;
template class LinearInterpolator<3>;

}  // namespace crease

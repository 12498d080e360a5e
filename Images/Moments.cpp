#include "Images/Moments.h"

#include "Core/Parallel.h"
#include "Images/IntensityRange.h"
#include "Images/MaskedPixels.h"

namespace crease {
namespace {

/// Sums over pixels, with indices counted from the middle of the image.
template <int Dim>
struct Sums {
  double mass = 0;
  Vector<Dim> first = Vector<Dim>::Zero();
  Matrix<Dim> second = Matrix<Dim>::Zero();
  Sums& operator+=(const Sums& other) {
    mass += other.mass;
    first += other.first;
    second += other.second;
    return *this;
  }
};

template <int Dim>
Vector<Dim> middle_index(const Raster<Dim>& raster) {
  Vector<Dim> middle;
  for (int a = 0; a < Dim; ++a) middle[a] = 0.5 * (raster.size[a] - 1);
  return middle;
}

/// Sums over the mask, with mass scale * (intensity - offset) + base per pixel.
template <int Dim>
Sums<Dim> sum_pixels(const Image<float, Dim>& image, const Mask<Dim>* mask, double scale,
                     double offset, double base) {
  const Raster<Dim>& raster = image.raster();
  const Vector<Dim> middle = middle_index(raster);
  return parallel_sum(
      raster.num_rows(), Sums<Dim>{},
      [&](std::int64_t r, Sums<Dim>& sum) {
        double mass = 0, first = 0, second = 0;  // moments along the row
        const auto line = image.row(r);
        for (int i = 0; i < raster.size[0]; ++i) {
          const auto at = static_cast<std::size_t>(i);
          if (mask != nullptr && mask->row(r)[at] == 0) continue;
          const double m = scale * (static_cast<double>(line[at]) - offset) + base,
                       x = i - middle[0];
          mass += m;
          first += m * x;
          second += m * x * x;
        }
        Vector<Dim> position = Vector<Dim>::Zero();  // of the row
        position[1] = static_cast<double>(r % raster.size[1]) - middle[1];
        if constexpr (Dim == 3) {
          const std::int64_t k = r / raster.size[1];
          position[2] = static_cast<double>(k) - middle[2];
        }
        sum.mass += mass;
        sum.first += mass * position;
        sum.first[0] += first;
        sum.second += mass * position * position.transpose();
        sum.second.row(0) += first * position.transpose();
        sum.second.col(0) += first * position;
        sum.second(0, 0) += second;
      },
      16);
}

}  // namespace

template <int Dim>
Moments<Dim> moments(const Image<float, Dim>& image, const std::type_identity_t<Mask<Dim>>* mask) {
  check_mask(image, mask, "moments");
  const Raster<Dim>& raster = image.raster();
  const IntensityRange range = intensity_range(image, mask);
  const Sums<Dim> sums = range.constant() ? sum_pixels(image, mask, 0, 0, 1)
                                          : sum_pixels(image, mask, 1, range.lower, 0);
  const Vector<Dim> mean = sums.first / sums.mass;
  const Matrix<Dim> to_mm = raster.index_to_point();
  Moments<Dim> result;
  result.mass = range.constant() ? 0 : sums.mass * raster.sample_volume();
  result.centre = raster.point(middle_index(raster) + mean);
  result.covariance =
      to_mm * (sums.second / sums.mass - mean * mean.transpose()) * to_mm.transpose();
  return result;
}

template Moments<2> moments<2>(const Image<float, 2>&, const Mask<2>*);
template Moments<3> moments<3>(const Image<float, 3>&, const Mask<3>*);

}  // namespace crease

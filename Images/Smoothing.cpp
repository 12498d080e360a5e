#include "Images/Smoothing.h"

#include <cmath>

#include "Core/Error.h"
#include "Images/SeparableFilter.h"

namespace crease {
namespace {

/// Samples of a Gaussian at -radius .. radius that sum to 1.
std::vector<float> gaussian_weights(double sigma_pixels) {
  const int radius = std::max(1, static_cast<int>(std::ceil(4 * sigma_pixels)));
  std::vector<double> samples;
  double sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    samples.push_back(std::exp(-0.5 * k * k / (sigma_pixels * sigma_pixels)));
    sum += samples.back();
  }
  std::vector<float> weights;
  for (double s : samples) weights.push_back(static_cast<float>(s / sum));
  return weights;
}

}  // namespace

template <int Dim>
Image<float, Dim> smooth_121(const Image<float, Dim>& image) {
  constexpr std::array<float, 3> kWeights{0.25f, 0.5f, 0.25f};
  Image<float, Dim> result = filter_axis<Dim>(image, 0, kWeights, 1, 1, image.raster());
  for (int a = 1; a < Dim; ++a) {
    result = filter_axis<Dim>(result, a, kWeights, 1, 1, image.raster());
  }
  return result;
}

template <int Dim>
Image<float, Dim> gaussian_smooth(const Image<float, Dim>& image, double sigma_mm) {
  if (!std::isfinite(sigma_mm) || sigma_mm < 0) {
    throw InvalidInput(
        message("gaussian_smooth: sigma is ", sigma_mm, " mm; it must not be negative"));
  }
  Image<float, Dim> result;
  for (int a = 0; a < Dim; ++a) {
    const double sigma = sigma_mm / image.raster().spacing[a];
    if (sigma < 0.1) continue;
    const auto weights = gaussian_weights(std::min<double>(sigma, 4.0 * image.size()[a]));
    result = filter_axis<Dim>(result.empty() ? image : result, a, weights,
                              static_cast<int>(weights.size()) / 2, 1, image.raster());
  }
  return result.empty() ? image : result;
}

template Image<float, 2> smooth_121<2>(const Image<float, 2>&);
template Image<float, 3> smooth_121<3>(const Image<float, 3>&);
template Image<float, 2> gaussian_smooth<2>(const Image<float, 2>&, double);
template Image<float, 3> gaussian_smooth<3>(const Image<float, 3>&, double);

}  // namespace crease

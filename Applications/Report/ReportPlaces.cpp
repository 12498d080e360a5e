#include "Applications/Report/ReportPlaces.h"

#include <algorithm>
#include <cmath>

namespace crease {

template <int Dim>
std::vector<Extreme<Dim>> extremes(const Image<float, Dim>& image, const Mask<Dim>& mask,
                                   bool largest, int count) {
  const Raster<Dim>& raster = image.raster();
  double longest = 0;
  for (int a = 0; a < Dim; ++a) longest = std::max(longest, raster.size[a] * raster.spacing[a]);
  const double apart = longest / 12;
  std::vector<std::uint8_t> open = mask.values();
  std::vector<Extreme<Dim>> found;
  const auto point = [&](std::int64_t n) {
    const auto index = image.index(n);
    Vector<Dim> i;
    for (int a = 0; a < Dim; ++a) i[a] = index[a];
    return raster.point(i);
  };
  while (std::ssize(found) < count) {
    std::int64_t best = -1;
    for (std::int64_t n = 0; n < raster.num_samples(); ++n) {
      const float value = image.values()[static_cast<std::size_t>(n)];
      if (!open[static_cast<std::size_t>(n)] || !std::isfinite(value)) continue;
      const float so_far = best < 0 ? 0 : image.values()[static_cast<std::size_t>(best)];
      if (best < 0 || (largest ? value > so_far : value < so_far)) best = n;
    }
    if (best < 0) break;
    found.push_back({point(best), image.values()[static_cast<std::size_t>(best)]});
    if (std::ssize(found) == count) break;
    for (std::int64_t n = 0; n < raster.num_samples(); ++n) {
      if ((point(n) - found.back().at).norm() < apart) open[static_cast<std::size_t>(n)] = 0;
    }
  }
  return found;
}

template std::vector<Extreme<2>> extremes<2>(const Image<float, 2>&, const Mask<2>&, bool, int);
template std::vector<Extreme<3>> extremes<3>(const Image<float, 3>&, const Mask<3>&, bool, int);

}  // namespace crease

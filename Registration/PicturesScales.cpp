#include "Registration/PicturesScales.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "Images/IntensityRange.h"

namespace crease {
namespace {

canvas::Colour diverging_at(double position) { return canvas::diverging(2 * position - 1); }

// The smallest of 1, 1.5, 2, 3, 5, 7 times a power of ten that is not below the value.
double rounded_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.0}) {
    if (value <= step * power * (1 + 1e-12)) return step * power;
  }
  return 10 * power;
}

// The image with 0 where it is not finite.
template <int Dim>
Image<float, Dim> finite(const Image<float, Dim>& image) {
  Image<float, Dim> result = image;
  for (float& v : result.values()) {
    if (!std::isfinite(v)) v = 0;
  }
  return result;
}

}  // namespace

std::string short_number(double value) {
  std::ostringstream text;
  text.precision(std::abs(value) >= 1 ? 3 : 2);
  text << value;
  return text.str();
}

double ColourScale::position(double value) const {
  if (logarithmic) return std::log(value / lower) / std::log(upper / lower);
  return (value - lower) / (upper - lower);
}

template <int Dim>
ColourScale difference_scale(const Image<float, Dim>& difference) {
  const IntensityRange range = intensity_percentiles(finite(difference), nullptr, 0.5, 99.5);
  double end = std::max(std::abs(range.lower), std::abs(range.upper));
  if (!(end > 0)) end = 1;
  ColourScale scale{.lower = -end, .upper = end, .colour = diverging_at};
  for (const double t : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    scale.ticks.emplace_back(0.5 + 0.5 * t, short_number(t * end));
  }
  return scale;
}

template <int Dim>
DeterminantSummary summarize_determinants(const Image<float, Dim>& determinants) {
  DeterminantSummary summary{.minimum = std::numeric_limits<double>::infinity(),
                             .maximum = -std::numeric_limits<double>::infinity()};
  for (const double d : determinants.values()) {
    if (!std::isfinite(d)) continue;
    ++summary.defined;
    summary.folded += d <= 0;
    summary.minimum = std::min(summary.minimum, d);
    summary.maximum = std::max(summary.maximum, d);
  }
  return summary;
}

ColourScale determinant_scale(const DeterminantSummary& summary) {
  double farthest = std::max(1.0, summary.maximum);
  if (summary.minimum > 0) farthest = std::max(farthest, 1 / summary.minimum);
  if (summary.folded > 0) farthest = std::max(farthest, 4.0);
  double end = 5;
  for (const double larger : {4.0, 3.0, 2.0, 1.5, 1.25, 1.1}) {
    if (farthest <= larger) end = larger;
  }
  // between 1 and the end, a round number near the middle of the logarithmic scale
  const double half = end >= 3 ? 2 : end >= 2 ? 1.5 : end >= 1.5 ? 1.25 : end > 1.1 ? 1.1 : 1.05;
  ColourScale scale{.lower = 1 / end, .upper = end, .logarithmic = true, .colour = diverging_at};
  for (const double d : {1 / end, 1 / half, 1.0, half, end}) {
    scale.ticks.emplace_back(scale.position(d), short_number(d));
  }
  return scale;
}

template <int Dim>
ColourScale strain_scale(const Image<float, Dim>& strain) {
  constexpr double kSmallest = 1e-3;  // below that a map is rigid to the eye
  constexpr double kLargest = 2;      // beyond that it is beyond belief
  const double high = intensity_percentiles(finite(strain), nullptr, 0, 99.9).upper;
  ColourScale scale{.upper = rounded_up(std::clamp(high, kSmallest, kLargest))};
  for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    scale.ticks.emplace_back(t, short_number(t * scale.upper));
  }
  return scale;
}

template ColourScale difference_scale<2>(const Image<float, 2>&);
template ColourScale difference_scale<3>(const Image<float, 3>&);
template DeterminantSummary summarize_determinants<2>(const Image<float, 2>&);
template DeterminantSummary summarize_determinants<3>(const Image<float, 3>&);
template ColourScale strain_scale<2>(const Image<float, 2>&);
template ColourScale strain_scale<3>(const Image<float, 3>&);

}  // namespace crease

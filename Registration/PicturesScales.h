#pragma once

#include <string>
#include <utility>
#include <vector>

#include "Images/Image.h"
#include "Registration/PicturesCanvas.h"

namespace crease {

/// Values as colours: `lower` lies at position 0 of the colours and `upper` at 1, in equal steps between
/// or, logarithmic, in equal ratios.
struct ColourScale {
  double lower = 0, upper = 1;
  bool logarithmic = false;
  canvas::Colour (*colour)(double position) = canvas::sequential;
  std::vector<std::pair<double, std::string>> ticks = {};  ///< position and text

  /// Of a value, which must be positive where the scale is logarithmic; outside 0 to 1 beyond the ends.
  double position(double value) const;
};

/// Blue over white to red, from -s to s, where s exceeds 99.5 % of the values' magnitudes on either side.
template <int Dim>
ColourScale difference_scale(const Image<float, Dim>& difference);

/// What the determinants of a map are like over the samples where they are finite.
struct DeterminantSummary {
  double minimum = 0, maximum = 0;  ///< infinite when none is defined
  std::int64_t folded = 0, defined = 0;
};
template <int Dim>
DeterminantSummary summarize_determinants(const Image<float, Dim>& determinants);

/// Blue over white to red in equal ratios from 1/R to R, R between 1.1 and 5.
ColourScale determinant_scale(const DeterminantSummary& summary);

/// Dark blue over green to yellow (viridis) from 0 to a round number that exceeds 99.9 % of the strains, 2 at most.
template <int Dim>
ColourScale strain_scale(const Image<float, Dim>& strain);

/// A short number: 0.25, 1.4, 12.
std::string short_number(double value);

extern template ColourScale difference_scale<2>(const Image<float, 2>&);
extern template ColourScale difference_scale<3>(const Image<float, 3>&);
extern template DeterminantSummary summarize_determinants<2>(const Image<float, 2>&);
extern template DeterminantSummary summarize_determinants<3>(const Image<float, 3>&);
extern template ColourScale strain_scale<2>(const Image<float, 2>&);
extern template ColourScale strain_scale<3>(const Image<float, 3>&);

}  // namespace crease

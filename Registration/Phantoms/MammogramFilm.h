#pragma once

#include "Images/Image.h"
#include "Registration/Phantoms/Random.h"

// What film and scanner make of a breast: everything that does not move with the tissue. Greys are 0 to 1.
namespace crease {

/// The film itself: 0.02, 0.028 at the lower edge, and if wanted a label of two bright rectangles in the
/// upper corner that the breast does not reach.
/// @param mirrored  the chest wall is on the right, the label on the left.
Image<double, 2> exposed_film(const Raster<2>& raster, bool mirrored, bool label);

/// Gaussian blur of 0.7 pixels.
void blur_film(Image<double, 2>& image);

/// How a film answers to light: grey -> gain grey^gamma.
struct FilmResponse {
  double gain = 1, gamma = 1;
};
/// Gain and gamma within 0.9 .. 1.1.
FilmResponse draw_response(Random random);
void apply_response(Image<double, 2>& image, const FilmResponse& response);

/// Adds normal deviates of the given deviation.
void add_film_noise(Image<double, 2>& image, double deviation, Random random);

/// Whole grey levels, 0 to 2^bits - 1; greys outside 0 .. 1 become black or white.
Image<float, 2> digitised(const Image<double, 2>& image, int bits);

}  // namespace crease

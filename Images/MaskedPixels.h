#pragma once

#include <string_view>

#include "Images/Image.h"

namespace crease {

/// @throws InvalidInput unless mask is null or as large as the image and not empty.
template <int Dim>
void check_mask(const Image<float, Dim>& image, const Mask<Dim>* mask, std::string_view what) {
  if (image.empty()) throw InvalidInput(message(what, ": the image has no pixels"));
  if (mask == nullptr) return;
  if (mask->size() != image.size()) {
    throw InvalidInput(message(what,
                               ": the mask has another size than the image; resample it "
                               "onto the image's raster"));
  }
  for (std::uint8_t v : mask->values()) {
    if (v != 0) return;
  }
  throw InvalidInput(message(what, ": the mask is empty; no pixel of the image counts"));
}

}  // namespace crease

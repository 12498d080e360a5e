#pragma once

#include "Images/Image.h"
#include "Registration/CreasedDomain.h"
#include "Registration/Pictures.h"
#include "Registration/PicturesScales.h"
#include "Transforms/Energies/ElasticMaterial.h"

namespace crease {

/// Young's modulus at every sample of a raster; NaN outside the body.
Image<float, 2> stiffness_map(const CreasedDomain& domain, const ElasticMaterial& material,
                              const Raster<2>& raster);

/// Dark blue over green to yellow from the softest to the stiffest tissue, in equal ratios.
ColourScale stiffness_scale(const Image<float, 2>& stiffness);

/// The map as a picture with its scale; grey outside the body.
Picture stiffness_picture(const Image<float, 2>& stiffness);

}  // namespace crease

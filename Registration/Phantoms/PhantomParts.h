#pragma once

#include <functional>
#include <memory>

#include "Registration/Phantoms/Phantom.h"
#include "Registration/Phantoms/PowerLawTexture.h"
#include "Registration/Phantoms/Random.h"

namespace crease {

/// Uses of a phantom's seed (Random's streams).
enum class Stream { kMotion = 1, kTexture, kObjects, kFixedNoise, kMovingNoise, kLandmarks };

Random random_stream(const PhantomOptions& options, Stream stream);

/// size x size pixels of 1 mm, the first centre at (0, 0).
Raster<2> phantom_raster(int size);

/// f^-1.5 texture with blur of 1.2 mm for an image of the options' size; null when turned off.
std::shared_ptr<const PowerLawTexture> make_texture(const PhantomOptions& options);

/// T(x) - x at every sample.
DisplacementField<2> sample_displacement(const Raster<2>& raster,
                                         const std::function<Point<2>(const Point<2>&)>& map);

/// Smallest and largest det of the map's central differences over two pixels.
std::pair<double, double> determinant_range(const DisplacementField<2>& displacement);

/// Fills fixed and moving from the moving image's analytic function and the displacement, and adds
/// noise.
void sample_images(Phantom& phantom, const std::function<double(const Point<2>&)>& scene,
                   double noise, const PhantomOptions& options);

}  // namespace crease

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

/// `size` pixels of 1 mm along every axis, the first centre at the origin.
template <int Dim>
Raster<Dim> phantom_raster(int size);

/// f^-1.5 texture with blur of 1.2 mm for an image of the options' size; null when turned off.
template <int Dim>
std::shared_ptr<const PowerLawTexture<Dim>> make_texture(const PhantomOptions& options);

/// T(x) - x at every sample.
template <int Dim>
DisplacementField<Dim> displacement_of(const Raster<Dim>& raster,
                                       const std::function<Point<Dim>(const Point<Dim>&)>& map);

/// Smallest and largest det of the map's central differences over two pixels.
template <int Dim>
std::pair<double, double> determinant_range(const DisplacementField<Dim>& displacement);

/// Fills fixed and moving from the moving image's analytic function and the displacement, and adds
/// noise.
template <int Dim>
void sample_images(PhantomImages<Dim>& phantom,
                   const std::function<double(const Point<Dim>&)>& scene, double noise,
                   const PhantomOptions& options);

}  // namespace crease

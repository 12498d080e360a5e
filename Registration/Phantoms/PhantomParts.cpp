#include "Registration/Phantoms/PhantomParts.h"

#include <algorithm>
#include <limits>

#include "Core/Parallel.h"

namespace crease {
namespace {

void add_noise(Image<float, 2>& image, double deviation, Random random) {
  if (deviation == 0) return;
  for (float& value : image.values()) {
    value = static_cast<float>(value + deviation * random.normal());
  }
}

}  // namespace

Random random_stream(const PhantomOptions& options, Stream stream) {
  return Random(options.seed, static_cast<std::uint64_t>(stream));
}

Raster<2> phantom_raster(int size) {
  Raster<2> raster;
  raster.size = {size, size};
  return raster;
}

std::shared_ptr<const PowerLawTexture> make_texture(const PhantomOptions& options) {
  if (!options.texture) return nullptr;
  constexpr double kExponent = 1.5, kBlurMm = 1.2;
  return std::make_shared<PowerLawTexture>(options.size, kExponent, kBlurMm,
                                           random_stream(options, Stream::kTexture));
}

DisplacementField<2> sample_displacement(const Raster<2>& raster,
                                         const std::function<Point<2>(const Point<2>&)>& map) {
  DisplacementField<2> field(raster, Vector<2>::Zero());
  parallel_for(raster.size[1], [&](std::int64_t j) {
    for (int i = 0; i < raster.size[0]; ++i) {
      const Point<2> x = raster.point({i, static_cast<double>(j)});
      field(i, static_cast<int>(j)) = map(x) - x;
    }
  });
  return field;
}

std::pair<double, double> determinant_range(const DisplacementField<2>& field) {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  const Vector<2> step = 2 * field.raster().spacing;
  for (int j = 1; j + 1 < field.size()[1]; ++j) {
    for (int i = 1; i + 1 < field.size()[0]; ++i) {
      const Vector<2> x = Vector<2>::UnitX() + (field(i + 1, j) - field(i - 1, j)) / step.x();
      const Vector<2> y = Vector<2>::UnitY() + (field(i, j + 1) - field(i, j - 1)) / step.y();
      const double det = x.x() * y.y() - x.y() * y.x();
      lower = std::min(lower, det);
      upper = std::max(upper, det);
    }
  }
  return {lower, upper};
}

void sample_images(Phantom& phantom, const std::function<double(const Point<2>&)>& scene,
                   double noise, const PhantomOptions& options) {
  const Raster<2>& raster = phantom.displacement.raster();
  phantom.fixed = phantom.moving = Image<float, 2>(raster);
  parallel_for(raster.size[1], [&](std::int64_t row) {
    const int j = static_cast<int>(row);
    for (int i = 0; i < raster.size[0]; ++i) {
      const Point<2> x = raster.point({double(i), double(j)});
      phantom.moving(i, j) = static_cast<float>(scene(x));
      phantom.fixed(i, j) = static_cast<float>(scene(x + phantom.displacement(i, j)));
    }
  });
  add_noise(phantom.fixed, noise, random_stream(options, Stream::kFixedNoise));
  add_noise(phantom.moving, noise, random_stream(options, Stream::kMovingNoise));
}

}  // namespace crease

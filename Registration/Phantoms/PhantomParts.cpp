#include "Registration/Phantoms/PhantomParts.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "Core/Parallel.h"

namespace crease {
namespace {

template <int Dim>
void add_noise(Image<float, Dim>& image, double deviation, Random random) {
  if (deviation == 0) return;
  for (float& value : image.values()) {
    value = static_cast<float>(value + deviation * random.normal());
  }
}

/// Calls f(sample's position in the image, its point) for all samples, in parallel.
template <int Dim, typename Function>
void for_each_sample(const Raster<Dim>& raster, const Function& f) {
  const Vector<Dim> step = raster.index_to_point().col(0);
  parallel_for(raster.num_rows(), [&](std::int64_t row) {
    const Point<Dim> start = raster.row_start(row);
    for (int i = 0; i < raster.size[0]; ++i) {
      f(static_cast<std::size_t>(row * raster.size[0] + i), Point<Dim>(start + i * step));
    }
  });
}

}  // namespace

Random random_stream(const PhantomOptions& options, Stream stream) {
  return Random(options.seed, static_cast<std::uint64_t>(stream));
}

template <int Dim>
Raster<Dim> phantom_raster(int size) {
  Raster<Dim> raster;
  raster.size.fill(size);
  return raster;
}

template <int Dim>
std::shared_ptr<const PowerLawTexture<Dim>> make_texture(const PhantomOptions& options) {
  if (!options.texture) return nullptr;
  constexpr double kExponent = 1.5, kBlurMm = 1.2;
  return std::make_shared<PowerLawTexture<Dim>>(options.size, kExponent, kBlurMm,
                                                random_stream(options, Stream::kTexture));
}

template <int Dim>
DisplacementField<Dim> displacement_of(const Raster<Dim>& raster,
                                       const std::function<Point<Dim>(const Point<Dim>&)>& map) {
  DisplacementField<Dim> field(raster, Vector<Dim>::Zero());
  for_each_sample(raster, [&](std::size_t position, const Point<Dim>& x) {
    field.values()[position] = map(x) - x;
  });
  return field;
}

template <int Dim>
std::pair<double, double> determinant_range(const DisplacementField<Dim>& field) {
  const Raster<Dim>& raster = field.raster();
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  for (std::int64_t position = 0; position < raster.num_samples(); ++position) {
    const auto index = field.index(position);
    Matrix<Dim> jacobian = Matrix<Dim>::Identity();
    bool inside = true;
    for (int a = 0; a < Dim && inside; ++a) {
      inside = index[a] > 0 && index[a] + 1 < raster.size[a];
      if (!inside) break;
      auto next = index, previous = index;
      ++next[a];
      --previous[a];
      jacobian.col(a) += (field[next] - field[previous]) / (2 * raster.spacing[a]);
    }
    if (!inside) continue;
    const double det = jacobian.determinant();
    lower = std::min(lower, det);
    upper = std::max(upper, det);
  }
  return {lower, upper};
}

template <int Dim>
void sample_images(PhantomImages<Dim>& phantom,
                   const std::function<double(const Point<Dim>&)>& scene, double noise,
                   const PhantomOptions& options) {
  const Raster<Dim>& raster = phantom.displacement.raster();
  phantom.fixed = phantom.moving = Image<float, Dim>(raster);
  for_each_sample(raster, [&](std::size_t position, const Point<Dim>& x) {
    phantom.moving.values()[position] = static_cast<float>(scene(x));
    phantom.fixed.values()[position] =
        static_cast<float>(scene(x + phantom.displacement.values()[position]));
  });
  add_noise(phantom.fixed, noise, random_stream(options, Stream::kFixedNoise));
  add_noise(phantom.moving, noise, random_stream(options, Stream::kMovingNoise));
}

#define CREASE_INSTANTIATE(Dim)                                                                  \
  template Raster<Dim> phantom_raster<Dim>(int);                                                 \
  template std::shared_ptr<const PowerLawTexture<Dim>> make_texture<Dim>(const PhantomOptions&); \
  template DisplacementField<Dim> displacement_of<Dim>(                                          \
      const Raster<Dim>&, const std::function<Point<Dim>(const Point<Dim>&)>&);                  \
  template std::pair<double, double> determinant_range<Dim>(const DisplacementField<Dim>&);      \
  template void sample_images<Dim>(PhantomImages<Dim>&,                                          \
                                   const std::function<double(const Point<Dim>&)>&, double,      \
                                   const PhantomOptions&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease

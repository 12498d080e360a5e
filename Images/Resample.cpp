#include "Images/Resample.h"

#include <cmath>

#include "Core/Parallel.h"

namespace crease {
namespace {

/// One set of row buffers, with room for the kernels of transforms on both sides.
template <int Dim>
struct RowBuffers {
  explicit RowBuffers(int width) {
    for (int a = 0; a < Dim; ++a) {
      storage[a].assign(static_cast<std::size_t>(width) + 48, 0.0f);
      pointers[a] = storage[a].data() + 16;
    }
  }
  std::array<std::vector<float>, Dim> storage;
  std::array<float*, Dim> pointers{};
};

template <int Dim>
Point<Dim> mapped_point(const MappedRow<Dim>& row, int i) {
  Point<Dim> p = row.start + i * row.step;
  for (int a = 0; a < Dim; ++a) {
    if (row.displacement[a] != nullptr) p[a] += static_cast<double>(row.displacement[a][i]);
  }
  return p;
}

template <typename Pixel, int Dim>
Pixel nearest_pixel(const Image<Pixel, Dim>& image, const Matrix<Dim>& point_to_index,
                    const Point<Dim>& p, Pixel outside) {
  const Vector<Dim> index = point_to_index * (p - image.raster().origin);
  std::array<int, Dim> pixel;
  for (int a = 0; a < Dim; ++a) {
    const int last = image.size()[a] - 1;
    if (!(index[a] >= -0.5 && index[a] <= last + 0.5)) return outside;
    pixel[a] = std::min(static_cast<int>(std::floor(index[a] + 0.5)), last);
  }
  return image[pixel];
}

}  // namespace

template <int Dim>
RowMap<Dim> row_map(const DisplacementField<Dim>& field) {
  return [&field](std::int64_t r, const std::array<float*, Dim>& buffers) {
    const Raster<Dim>& raster = field.raster();
    const auto line = field.row(r);
    for (int i = 0; i < raster.size[0]; ++i) {
      for (int a = 0; a < Dim; ++a) {
        buffers[a][i] = static_cast<float>(line[static_cast<std::size_t>(i)][a]);
      }
    }
    MappedRow<Dim> row;
    row.row = r;
    row.end = raster.size[0];
    row.start = raster.row_start(r);
    row.step = raster.index_to_point().col(0);
    for (int a = 0; a < Dim; ++a) row.displacement[a] = buffers[a];
    return row;
  };
}

template <int Dim>
Image<float, Dim> resample(const Interpolator<Dim>& moving, const Raster<Dim>& raster,
                           const std::type_identity_t<PointMap<Dim>>& map, float outside) {
  Image<float, Dim> result(raster, outside);
  const Vector<Dim> step = raster.index_to_point().col(0);
  parallel_for(raster.num_rows(), [&](std::int64_t r) {
    const Point<Dim> start = raster.row_start(r);
    const auto line = result.row(r);
    for (int i = 0; i < raster.size[0]; ++i) {
      const auto sample = moving.evaluate(map(start + i * step));
      if (sample.inside) line[static_cast<std::size_t>(i)] = static_cast<float>(sample.value);
    }
  });
  return result;
}

template <int Dim>
Image<float, Dim> resample(const Interpolator<Dim>& moving, const Raster<Dim>& raster,
                           const std::type_identity_t<RowMap<Dim>>& map, float outside) {
  Image<float, Dim> result(raster, outside);
  parallel_for(raster.num_rows(), [&](std::int64_t r) {
    const RowBuffers<Dim> buffers(raster.size[0]);
    const MappedRow<Dim> row = map(r, buffers.pointers);
    const auto width = static_cast<std::size_t>(raster.size[0]) + 32;
    std::vector<float> value(width), inside(width);
    moving.evaluate_row(row, value.data() + 16, {}, inside.data() + 16);
    const auto line = result.row(r);
    for (auto i = static_cast<std::size_t>(row.begin); i < static_cast<std::size_t>(row.end); ++i) {
      if (inside[i + 16] != 0) line[i] = value[i + 16];
    }
  });
  return result;
}

template <typename Pixel, int Dim>
Image<Pixel, Dim> resample_nearest(const Image<Pixel, Dim>& moving, const Raster<Dim>& raster,
                                   const std::type_identity_t<PointMap<Dim>>& map,
                                   std::type_identity_t<Pixel> outside) {
  Image<Pixel, Dim> result(raster, outside);
  const Matrix<Dim> point_to_index = moving.raster().point_to_index();
  const Vector<Dim> step = raster.index_to_point().col(0);
  parallel_for(raster.num_rows(), [&](std::int64_t r) {
    const Point<Dim> start = raster.row_start(r);
    const auto line = result.row(r);
    for (int i = 0; i < raster.size[0]; ++i) {
      line[static_cast<std::size_t>(i)] =
          nearest_pixel(moving, point_to_index, map(start + i * step), outside);
    }
  });
  return result;
}

template <typename Pixel, int Dim>
Image<Pixel, Dim> resample_nearest(const Image<Pixel, Dim>& moving, const Raster<Dim>& raster,
                                   const std::type_identity_t<RowMap<Dim>>& map,
                                   std::type_identity_t<Pixel> outside) {
  Image<Pixel, Dim> result(raster, outside);
  const Matrix<Dim> point_to_index = moving.raster().point_to_index();
  parallel_for(raster.num_rows(), [&](std::int64_t r) {
    const RowBuffers<Dim> buffers(raster.size[0]);
    const MappedRow<Dim> row = map(r, buffers.pointers);
    const auto line = result.row(r);
    for (int i = row.begin; i < row.end; ++i) {
      line[static_cast<std::size_t>(i)] =
          nearest_pixel(moving, point_to_index, mapped_point(row, i), outside);
    }
  });
  return result;
}

#define CREASE_INSTANTIATE_NEAREST(Pixel, Dim)                                    \
  template Image<Pixel, Dim> resample_nearest<Pixel, Dim>(                        \
      const Image<Pixel, Dim>&, const Raster<Dim>&, const PointMap<Dim>&, Pixel); \
  template Image<Pixel, Dim> resample_nearest<Pixel, Dim>(                        \
      const Image<Pixel, Dim>&, const Raster<Dim>&, const RowMap<Dim>&, Pixel);
#define CREASE_INSTANTIATE(Dim)                                                          \
  template RowMap<Dim> row_map<Dim>(const DisplacementField<Dim>&);                      \
  template Image<float, Dim> resample<Dim>(const Interpolator<Dim>&, const Raster<Dim>&, \
                                           const PointMap<Dim>&, float);                 \
  template Image<float, Dim> resample<Dim>(const Interpolator<Dim>&, const Raster<Dim>&, \
                                           const RowMap<Dim>&, float);                   \
  CREASE_INSTANTIATE_NEAREST(float, Dim)                                                 \
  CREASE_INSTANTIATE_NEAREST(std::uint8_t, Dim)                                          \
  CREASE_INSTANTIATE_NEAREST(std::int32_t, Dim)

CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)

}  // namespace crease

#include <algorithm>
#include <cmath>
#include <limits>

#include "Images/Files/FileBytes.h"
#include "Images/Files/ReadRaw.h"
#include "Images/ImageFile.h"

namespace crease {
namespace {

template <int Dim>
Raster<Dim> raster_of(const std::filesystem::path& path, const RawImage& image) {
  if (std::ssize(image.size) != Dim) {
    fail(path,
         message("the image has ", image.size.size(), " dimensions where ", Dim, " are needed"));
  }
  Raster<Dim> raster;
  std::copy_n(image.size.begin(), Dim, raster.size.begin());
  raster.spacing = Eigen::Map<const Vector<Dim>>(image.spacing.data());
  raster.origin = Eigen::Map<const Point<Dim>>(image.origin.data());
  raster.direction = Eigen::Map<const Matrix<Dim>>(image.direction.data());
  return raster;
}

template <int Dim>
std::string index_text(const Raster<Dim>& raster, std::int64_t position) {
  std::ostringstream text;
  for (int a = 0; a < Dim; ++a) {
    text << (a == 0 ? "(" : ", ") << position % raster.size[a];
    position /= raster.size[a];
  }
  return text.str() + ")";
}

/// Whole numbers beyond 2^24 do not all exist in single precision.
template <typename T>
std::int64_t convert(const T* from, std::span<float> to) {
  std::int64_t rounded = 0;
  for (std::size_t p = 0; p < to.size(); ++p) {
    to[p] = static_cast<float>(from[p]);
    if constexpr (std::is_integral_v<T> && sizeof(T) >= 4) {
      rounded += static_cast<long double>(to[p]) != static_cast<long double>(from[p]);
    }
  }
  return rounded;
}

ImageHeader header_of(const std::filesystem::path& path, const RawImage& image) {
  ImageHeader header;
  header.format = image_format(path);
  header.dimension = static_cast<int>(image.size.size());
  std::ranges::copy(image.size, header.size.begin());
  const int n = header.dimension;
  header.spacing.head(n) = Eigen::Map<const Eigen::VectorXd>(image.spacing.data(), n);
  header.origin.head(n) = Eigen::Map<const Eigen::VectorXd>(image.origin.data(), n);
  header.direction.topLeftCorner(n, n) =
      Eigen::Map<const Eigen::MatrixXd>(image.direction.data(), n, n);
  header.pixel_type = image.type;
  header.num_components = image.num_components;
  header.notes = image.notes;
  return header;
}

}  // namespace

ImageHeader read_image_header(const std::filesystem::path& path) {
  return header_of(path, read_raw(path, false));
}

ImageInfo read_image_info(const std::filesystem::path& path) {
  RawImage image = read_raw(path);
  ImageInfo info{.header = header_of(path, image)};
  if (image.colour) {
    make_grey(path, image);
    info.header.notes = image.notes;
  }
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  with_pixel_type(image.type, [&](auto zero) {
    const auto* values = image.values<decltype(zero)>();
    for (std::int64_t p = 0; p < image.num_values(); ++p) {
      const auto v = static_cast<double>(values[p]);
      if (!std::isfinite(v)) {
        ++info.num_not_finite;
        continue;
      }
      lower = std::min(lower, v);
      upper = std::max(upper, v);
    }
  });
  if (lower <= upper) {
    info.minimum = lower;
    info.maximum = upper;
  }
  return info;
}

template <int Dim>
ReadImage<Dim> read_image(const std::filesystem::path& path) {
  RawImage raw = read_raw(path);
  const Raster<Dim> raster = raster_of<Dim>(path, raw);
  ReadImage<Dim> result;
  result.format = image_format(path);
  result.pixel_type = raw.type;
  result.spacing_known = raw.spacing_known;
  make_grey(path, raw);
  result.notes = raw.notes;
  result.image = Image<float, Dim>(raster);
  const std::int64_t rounded = with_pixel_type(raw.type, [&](auto zero) {
    return convert(raw.values<decltype(zero)>(), result.image.values());
  });
  if (rounded > 0) {
    result.notes.push_back(message(rounded, " values beyond 2^24 are rounded to single precision"));
  }
  return result;
}

template <int Dim>
Mask<Dim> read_mask(const std::filesystem::path& path) {
  RawImage raw = read_raw(path);
  const Raster<Dim> raster = raster_of<Dim>(path, raw);
  make_grey(path, raw);
  Mask<Dim> mask(raster);
  with_pixel_type(raw.type, [&](auto zero) {
    const auto* values = raw.values<decltype(zero)>();
    for (std::int64_t p = 0; p < raw.num_pixels(); ++p) {
      const auto at = static_cast<std::size_t>(p);
      if constexpr (std::is_floating_point_v<decltype(zero)>) {
        if (std::isnan(values[p])) {
          fail(path, message("pixel ", index_text(raster, p), " of the mask is not a number"));
        }
      }
      mask.values()[at] = values[p] > 0;
    }
  });
  return mask;
}

template <int Dim>
LabelImage<Dim> read_labels(const std::filesystem::path& path) {
  RawImage raw = read_raw(path);
  const Raster<Dim> raster = raster_of<Dim>(path, raw);
  const auto notes = raw.notes.size();
  make_grey(path, raw);
  if (raw.notes.size() > notes) fail(path, "a label image is grey; this one has colours");
  LabelImage<Dim> labels(raster);
  with_pixel_type(raw.type, [&](auto zero) {
    const auto* values = raw.values<decltype(zero)>();
    for (std::int64_t p = 0; p < raw.num_pixels(); ++p) {
      const auto v = static_cast<double>(values[p]);
      if (!(v >= 0 && v <= std::numeric_limits<std::int32_t>::max()) || v != std::floor(v)) {
        fail(path, message("pixel ", index_text(raster, p), " of the label image is ", v,
                           "; labels are whole numbers from 0 to 2^31 - 1"));
      }
      labels.values()[static_cast<std::size_t>(p)] = static_cast<std::int32_t>(v);
    }
  });
  return labels;
}

template <int Dim>
DisplacementField<Dim> read_displacement_field(const std::filesystem::path& path) {
  const RawImage raw = read_raw(path);
  const Raster<Dim> raster = raster_of<Dim>(path, raw);
  if (raw.num_components != Dim || raw.colour) {
    fail(path, message("a displacement field of ", Dim, " dimensions has ", Dim,
                       " numbers per pixel; this file has ", raw.num_components));
  }
  DisplacementField<Dim> field(raster);
  with_pixel_type(raw.type, [&](auto zero) {
    const auto* values = raw.values<decltype(zero)>();
    for (std::int64_t p = 0; p < raw.num_pixels(); ++p) {
      for (int a = 0; a < Dim; ++a) {
        field.values()[static_cast<std::size_t>(p)][a] = static_cast<double>(values[p * Dim + a]);
      }
    }
  });
  return field;
}

template <int Dim>
NonFinitePixels<Dim> find_non_finite(const Image<float, Dim>& image) {
  NonFinitePixels<Dim> found;
  for (std::int64_t p = 0; p < std::ssize(image.values()); ++p) {
    if (std::isfinite(image.values()[static_cast<std::size_t>(p)])) continue;
    if (found.count++ == 0) found.first = image.index(p);
  }
  return found;
}

template <int Dim>
void check_finite(const Image<float, Dim>& image, std::string_view name) {
  const auto found = find_non_finite(image);
  if (found.count == 0) return;
  throw InvalidInput(
      message(name, ": ", found.count, found.count == 1 ? " pixel is" : " pixels are",
              " not finite, the first at index ",
              index_text(image.raster(), static_cast<std::int64_t>(image.offset(found.first))),
              "; replace such values"));
}

#define CREASE_INSTANTIATE(Dim)                                                               \
  template ReadImage<Dim> read_image<Dim>(const std::filesystem::path&);                      \
  template Mask<Dim> read_mask<Dim>(const std::filesystem::path&);                            \
  template LabelImage<Dim> read_labels<Dim>(const std::filesystem::path&);                    \
  template DisplacementField<Dim> read_displacement_field<Dim>(const std::filesystem::path&); \
  template NonFinitePixels<Dim> find_non_finite<Dim>(const Image<float, Dim>&);               \
  template void check_finite<Dim>(const Image<float, Dim>&, std::string_view);

CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)

}  // namespace crease

#include "Applications/Report/ReportPlanes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "Images/PngEncoder.h"

namespace crease {
namespace {

/// Of all layers: a pixel takes a byte at most, and a third more in the page.
constexpr double kMostPixels = 8.8e6;
constexpr int kLongestSide = 256;  // pixels of a volume's slices
constexpr int kFewSlices = 20;     // per plane: rather smaller pixels than fewer slices

/// How a raster is shown: the pixels along each axis, and how many slices there are across each at most.
template <int Dim>
struct Reduction {
  std::array<int, Dim> sides;
  int slices = 1;
};

Reduction<2> reduction(const std::array<int, 2>& size, double most_pixels) {
  const double shrink = std::min(1.0, std::sqrt(most_pixels / size[0] / size[1]));
  const auto side = [&](int samples) {
    return std::max(1, static_cast<int>(std::floor(samples * shrink)));
  };
  return {{side(size[0]), side(size[1])}, 1};
}

/// Pixels of all slices of all planes.
double num_pixels(const std::array<int, 3>& size, const Reduction<3>& shown) {
  const double volume = double(shown.sides[0]) * shown.sides[1] * shown.sides[2];
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a)
    sum += volume / shown.sides[a] * std::min(size[a], shown.slices);
  return sum;
}

Reduction<3> reduction(const std::array<int, 3>& size, double most_pixels) {
  Reduction<3> shown{{}, *std::ranges::max_element(size)};
  const auto set_sides = [&](double longest) {
    for (std::size_t a = 0; a < 3; ++a)
      shown.sides[a] = std::min(size[a], static_cast<int>(longest));
  };
  double longest = kLongestSide;
  set_sides(longest);
  while (shown.slices > kFewSlices && num_pixels(size, shown) > most_pixels) --shown.slices;
  while (num_pixels(size, shown) > most_pixels) set_sides(longest *= 0.98);
  return shown;
}

std::string hex(const canvas::Colour& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

/// Each byte the mean of the samples that it covers.
std::vector<std::uint8_t> reduced(const Image<float, 2>& plane, int width, int height,
                                  const ReportScale& scale) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto edge = [](int pixel, int samples, int pixels) {
    return static_cast<int>(std::int64_t{pixel} * samples / pixels);
  };
  for (int y = 0; y < height; ++y) {
    const int y0 = edge(y, plane.size()[1], height), y1 = edge(y + 1, plane.size()[1], height);
    for (int x = 0; x < width; ++x) {
      const int x0 = edge(x, plane.size()[0], width), x1 = edge(x + 1, plane.size()[0], width);
      double sum = 0;
      int count = 0;
      bool special = false;
      for (int j = y0; j < y1; ++j) {
        for (int i = x0; i < x1; ++i) {
          const double value = plane(i, j);
          if (!std::isfinite(value)) continue;
          special |= scale.first == 2 && value <= 0;
          sum += value;
          ++count;
        }
      }
      bytes.push_back(special ? 1 : count == 0 ? 0 : scale.byte(sum / count));
    }
  }
  return bytes;
}

}  // namespace

template <int Dim>
ReportPlanes<Dim>::ReportPlanes(const Raster<Dim>& raster, int num_layers) : raster_(raster) {
  const auto shown = reduction(raster.size, kMostPixels / num_layers);
  for (Slice<Dim> slice : crease::slices(raster)) {
    slice.width = shown.sides[static_cast<std::size_t>(slice.first)];
    slice.height = shown.sides[static_cast<std::size_t>(slice.second)];
    slice.scale = {double(slice.width) / raster.size[slice.first],
                   double(slice.height) / raster.size[slice.second]};
    slices_.emplace_back();
    if constexpr (Dim == 2) {
      slices_.back() = {slice};
    } else {
      const int across = axis(num_planes() - 1);
      const int num_slices = std::min(shown.slices, raster.size[across]);
      for (int k = 0; k < num_slices; ++k) {
        slice.middle[across] =
            static_cast<int>((2 * std::int64_t{k} + 1) * raster.size[across] / (2 * num_slices));
        slices_.back().push_back(slice);
      }
    }
  }
}

template <int Dim>
int ReportPlanes<Dim>::axis(int plane) const {
  return Dim == 2 ? -1 : 2 - plane;  // axial, coronal, sagittal
}

template <int Dim>
std::vector<ReportPlane> ReportPlanes<Dim>::planes() const {
  const auto list = [](const Vector<Dim>& v) { return std::vector<double>(v.begin(), v.end()); };
  std::vector<ReportPlane> planes;
  for (int p = 0; p < num_planes(); ++p) {
    const Slice<Dim>& any = slices(p).front();
    ReportPlane plane;
    plane.name = any.name;
    plane.width = any.width;
    plane.height = any.height;
    plane.width_mm = raster_.size[any.first] * raster_.spacing[any.first];
    plane.height_mm = raster_.size[any.second] * raster_.spacing[any.second];
    plane.right_mm = list(raster_.index_to_point().col(any.first) / any.scale.x());
    plane.down_mm =
        list(raster_.index_to_point().col(any.second) / any.scale.y() * (any.flipped ? -1 : 1));
    for (const Slice<Dim>& slice : slices(p)) {
      Vector<Dim> corner, middle;
      for (int a = 0; a < Dim; ++a) corner[a] = slice.middle[a];
      for (int a = 0; a < Dim; ++a) middle[a] = corner[a];
      corner[slice.first] = 0.5 / slice.scale.x() - 0.5;
      corner[slice.second] = (slice.flipped ? slice.height - 0.5 : 0.5) / slice.scale.y() - 0.5;
      std::string label;
      if constexpr (Dim == 3) {
        const int across = axis(p);
        int letter = 0;
        raster_.direction.col(across).cwiseAbs().maxCoeff(&letter);
        label = fmt::format("slice {} of {}, {} = {:.1f} mm", slice.middle[across] + 1,
                            raster_.size[across], "xyz"[letter], raster_.point(middle)[letter]);
      }
      plane.slices.push_back({label, list(raster_.point(corner))});
    }
    planes.push_back(plane);
  }
  return planes;
}

template <int Dim>
std::string ReportPlanes<Dim>::note() const {
  std::string text;
  if constexpr (Dim == 3) {
    for (int p = 0; p < num_planes(); ++p) {
      const int all = raster_.size[axis(p)], shown = static_cast<int>(slices(p).size());
      if (shown == all) continue;
      text += fmt::format("{}{} of {} {} slices", text.empty() ? "This page shows " : ", ", shown,
                          all, slices(p).front().name);
    }
    if (!text.empty()) text += ". ";
  }
  double scale = 1;
  for (const auto& plane : slices_) scale = std::min(scale, plane.front().scale.minCoeff());
  if (scale < 1) {
    text += fmt::format("Pixels are shrunk to as little as {:.0f} % of the image's resolution. ",
                        100 * scale);
  }
  if (!text.empty()) text += "All samples are in the files beside this page.";
  return text;
}

template <int Dim>
std::optional<typename ReportPlanes<Dim>::Spot> ReportPlanes<Dim>::spot(
    int plane, const Point<Dim>& point) const {
  const Vector<Dim> index = raster_.index(point);
  for (int a = 0; a < Dim; ++a) {
    if (!(index[a] >= -0.5 && index[a] <= raster_.size[a] - 0.5)) return std::nullopt;
  }
  const auto& all = slices(plane);
  Spot spot{.slice = 0, .pixel = all.front().pixel(index)};
  if constexpr (Dim == 3) {
    const auto distance = [&](const Slice<Dim>& slice) {
      return std::abs(slice.middle[axis(plane)] - index[axis(plane)]);
    };
    spot.slice = static_cast<int>(std::ranges::min_element(all, {}, distance) - all.begin());
  }
  return spot;
}

template <int Dim>
std::vector<std::string> ReportPlanes<Dim>::encode(const SamplesOfSlice& samples,
                                                   const ReportScale& scale) const {
  std::vector<std::string> png;
  for (const auto& plane : slices_) {
    std::vector<std::uint8_t> atlas;
    for (const Slice<Dim>& slice : plane) {
      const auto bytes = reduced(samples(slice), slice.width, slice.height, scale);
      atlas.insert(atlas.end(), bytes.begin(), bytes.end());
    }
    png.push_back(encode_png(plane.front().width,
                             plane.front().height * static_cast<int>(plane.size()), 1, atlas));
  }
  return png;
}

ReportScale grey_scale(double lower, double upper, const std::string& label) {
  ReportScale scale;
  scale.lower = lower;
  scale.upper = upper;
  scale.colours = {"#000000", "#ffffff"};
  for (const double t : {0.0, 0.5, 1.0}) {
    const double value = lower + t * (upper - lower);
    const bool rounding = std::abs(value) < 1e-6 * (upper - lower);
    scale.ticks.emplace_back(t, short_number(rounding ? 0 : value));
  }
  scale.label = label;
  return scale;
}

ReportScale report_scale(const ColourScale& colours, const std::string& label) {
  constexpr int kStops = 32;
  ReportScale scale;
  scale.lower = colours.lower;
  scale.upper = colours.upper;
  scale.logarithmic = colours.logarithmic;
  for (int k = 0; k <= kStops; ++k)
    scale.colours.push_back(hex(colours.colour(double(k) / kStops)));
  scale.ticks = colours.ticks;
  scale.label = label;
  return scale;
}

template class ReportPlanes<2>;
template class ReportPlanes<3>;

}  // namespace crease

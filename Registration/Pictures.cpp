#include "Registration/Pictures.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Images/IntensityRange.h"
#include "Registration/PicturesCanvas.h"
#include "Registration/PicturesScales.h"
#include "Registration/PicturesSlices.h"

namespace crease {
namespace {

using canvas::Colour;
using canvas::Legend;
using Panels = std::vector<std::pair<std::string, Picture>>;

template <int Dim>
void check_same_size(const Image<float, Dim>& fixed, const Image<float, Dim>& other,
                     const char* what) {
  if (fixed.empty() || fixed.size() != other.size()) {
    throw InvalidInput(message("picture: the ", what,
                               " image must have the fixed image's pixels; resample it first"));
  }
}

std::string joined(const std::string& title, const std::string& slice) {
  return slice.empty() ? title : title + (title.empty() ? "" : ", ") + slice;
}

Colour grey(float value, const IntensityRange& window) {
  const double t = window.constant() ? 0.5 : (value - window.lower) / window.width();
  const auto g = static_cast<std::uint8_t>(std::lround(255 * std::clamp(t, 0.0, 1.0)));
  return {g, g, g};
}

// One picture pixel per sample of the plane.
template <typename Colouring>
Picture coloured(const Image<float, 2>& plane, const Colouring& colouring) {
  Picture picture = canvas::blank(plane.size()[0], plane.size()[1], canvas::kPaper);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      canvas::set_pixel(picture, x, y, colouring(x, y, plane(x, y)));
    }
  }
  return picture;
}

template <int Dim>
Picture grey_panel(const Image<float, Dim>& image, const Slice<Dim>& slice,
                   const IntensityRange& window) {
  return coloured(pixels(image, slice), [&](int, int, float value) { return grey(value, window); });
}

template <int Dim>
Image<float, Dim> difference(const Image<float, Dim>& fixed, const Image<float, Dim>& other) {
  Image<float, Dim> result(fixed.raster());
  for (std::size_t i = 0; i < result.values().size(); ++i) {
    result.values()[i] = other.values()[i] - fixed.values()[i];
  }
  return result;
}

template <int Dim>
double rms(const Image<float, Dim>& image, const Mask<Dim>* body) {
  double sum = 0;
  std::int64_t count = 0;
  for (std::size_t n = 0; n < image.values().size(); ++n) {
    const float v = image.values()[n];
    if (!std::isfinite(v) || (body != nullptr && body->values()[n] == 0)) continue;
    sum += double(v) * v;
    ++count;
  }
  return count == 0 ? 0 : std::sqrt(sum / static_cast<double>(count));
}

// The image with `value` where it is not finite.
template <int Dim>
Image<float, Dim> completed(const Image<float, Dim>& image, float value) {
  Image<float, Dim> result = image;
  for (float& v : result.values()) {
    if (!std::isfinite(v)) v = value;
  }
  return result;
}

// 1 at the picture's pixels of those samples for which wanted(value) holds: a sample covers its
// whole square, at least one pixel.
template <int Dim, typename Wanted>
Image<float, 2> flagged_pixels(const Image<float, Dim>& image, const Slice<Dim>& slice,
                               const Wanted& wanted) {
  const Image<float, 2> plane = samples(image, slice);
  Raster<2> raster;
  raster.size = {slice.width, slice.height};
  Image<float, 2> flags(raster, 0.0f);
  for (int j = 0; j < plane.size()[1]; ++j) {
    for (int i = 0; i < plane.size()[0]; ++i) {
      if (!wanted(plane(i, j))) continue;
      const int x0 = static_cast<int>(i * slice.scale.x());
      const int y0 = static_cast<int>(j * slice.scale.y());
      const int x1 = std::max(x0 + 1, static_cast<int>((i + 1) * slice.scale.x()));
      const int y1 = std::max(y0 + 1, static_cast<int>((j + 1) * slice.scale.y()));
      for (int y = y0; y < std::min(y1, slice.height); ++y) {
        for (int x = x0; x < std::min(x1, slice.width); ++x) flags(x, y) = 1;
      }
    }
  }
  return flags;
}

Legend legend_of(const ColourScale& scale) {
  Legend legend;
  legend.colour = scale.colour;
  legend.ticks = scale.ticks;
  return legend;
}

bool undefined(float value) { return !std::isfinite(value); }

constexpr Colour kFolded{57, 255, 20}, kUndefined{190, 190, 190};

template <int Dim>
Picture difference_panel(const Image<float, Dim>& difference, const Slice<Dim>& slice,
                         double scale) {
  const Image<float, 2> outside = flagged_pixels(difference, slice, undefined);
  return coloured(pixels(completed(difference, 0), slice), [&](int x, int y, float value) {
    return outside(x, y) > 0 ? kUndefined : canvas::diverging(value / scale);
  });
}

template <int Dim>
Picture determinant_panel(const Image<float, Dim>& determinants, const Slice<Dim>& slice,
                          double scale) {
  const auto is_folded = [](float d) { return d <= 0; };
  const Image<float, 2> folded = flagged_pixels(determinants, slice, is_folded);
  const Image<float, 2> missing = flagged_pixels(determinants, slice, undefined);
  Image<float, 2> level = samples(determinants, slice);  // log det / log scale
  for (float& d : level.values()) {
    d = d > 0 && std::isfinite(d) ? std::log(d) / std::log(static_cast<float>(scale)) : 0;
  }
  return coloured(canvas::resized(level, slice.width, slice.height),
                  [&](int x, int y, float value) {
                    if (folded(x, y) > 0) return kFolded;
                    return missing(x, y) > 0 ? kUndefined : canvas::diverging(value);
                  });
}

}  // namespace

template <int Dim>
Picture image_picture(const Image<float, Dim>& image, const std::string& title) {
  Panels panels;
  const Image<float, Dim> whole = completed(image, 0);
  const IntensityRange window = intensity_percentiles(whole);
  for (const auto& slice : slices(image.raster())) {
    panels.emplace_back(joined(title, slice.name), grey_panel(whole, slice, window));
  }
  return canvas::framed(panels, {}, {});
}

template <int Dim>
Picture checkerboard_picture(const Image<float, Dim>& fixed, const Image<float, Dim>& warped,
                             bool shared_window) {
  check_same_size(fixed, warped, "warped");
  constexpr int kSquares = 8;
  const Image<float, Dim> whole_fixed = completed(fixed, 0), whole_warped = completed(warped, 0);
  const IntensityRange fixed_window = intensity_percentiles(whole_fixed);
  const IntensityRange warped_window =
      shared_window ? fixed_window : intensity_percentiles(whole_warped);
  Panels panels;
  for (const auto& slice : slices(fixed.raster())) {
    const Image<float, 2> other = pixels(whole_warped, slice);
    const double square = double(std::max(slice.width, slice.height)) / kSquares;
    const auto colouring = [&](int x, int y, float value) {
      const bool show_fixed = (int(x / square) + int(y / square)) % 2 == 0;
      return show_fixed ? grey(value, fixed_window) : grey(other(x, y), warped_window);
    };
    panels.emplace_back(joined("Fixed and warped in turn", slice.name),
                        coloured(pixels(whole_fixed, slice), colouring));
  }
  return canvas::framed(panels, {}, {});
}

template <int Dim>
Picture difference_picture(const Image<float, Dim>& fixed, const Image<float, Dim>& before,
                           const Image<float, Dim>& after, const Mask<Dim>* body) {
  check_same_size(fixed, before, "moving");
  check_same_size(fixed, after, "warped");
  if (body != nullptr && body->size() != fixed.size()) {
    throw InvalidInput("difference picture: the mask must have the fixed image's pixels.");
  }
  const Image<float, Dim> differences[] = {difference(fixed, before), difference(fixed, after)};
  const ColourScale scale = difference_scale(differences[0]);
  Legend legend = legend_of(scale);
  const char* const names[] = {"Before: moving - fixed", "After: warped - fixed"};
  Panels panels;
  for (const auto& slice : slices(fixed.raster())) {
    for (const int k : {0, 1}) {
      panels.emplace_back(joined(names[k], slice.name),
                          difference_panel(differences[k], slice, scale.upper));
    }
  }
  for (const auto& d : differences) {
    if (legend.swatches.empty() && std::any_of(d.values().begin(), d.values().end(), undefined)) {
      legend.swatches.emplace_back(kUndefined, "outside");
    }
  }
  return canvas::framed(panels, legend,
                        {std::string("rms difference ") + (body ? "in the body " : "") + "before " +
                         short_number(rms(differences[0], body)) + ", after " +
                         short_number(rms(differences[1], body))});
}

template <int Dim>
Picture jacobian_picture(const Image<float, Dim>& determinants) {
  const DeterminantSummary summary = summarize_determinants(determinants);
  const ColourScale scale = determinant_scale(summary);
  Legend legend = legend_of(scale);
  if (summary.folded > 0) legend.swatches.emplace_back(kFolded, "folded");
  Panels panels;
  for (const auto& slice : slices(determinants.raster())) {
    panels.emplace_back(joined("Jacobian det grad T", slice.name),
                        determinant_panel(determinants, slice, scale.upper));
  }
  std::string note = "no pixel has a value";
  if (summary.defined > 0) {
    note = message("smallest ", short_number(summary.minimum), ", largest ",
                   short_number(summary.maximum), "; ", summary.folded, " of ", summary.defined,
                   " pixels folded");
  }
  return canvas::framed(panels, legend, {note});
}

template <int Dim>
Picture strain_picture(const Image<float, Dim>& strain) {
  const ColourScale scale = strain_scale(strain);
  Panels panels;
  for (const auto& slice : slices(strain.raster())) {
    panels.emplace_back(joined("Strain |E| of T", slice.name),
                        coloured(pixels(strain, slice), [&](int, int, float value) {
                          return scale.colour(scale.position(value));
                        }));
  }
  const double largest = intensity_range(strain).upper;
  return canvas::framed(panels, legend_of(scale), {"largest " + short_number(largest)});
}

template Picture image_picture<2>(const Image<float, 2>&, const std::string&);
template Picture image_picture<3>(const Image<float, 3>&, const std::string&);
template Picture checkerboard_picture<2>(const Image<float, 2>&, const Image<float, 2>&, bool);
template Picture checkerboard_picture<3>(const Image<float, 3>&, const Image<float, 3>&, bool);
template Picture difference_picture<2>(const Image<float, 2>&, const Image<float, 2>&,
                                       const Image<float, 2>&, const Mask<2>*);
template Picture difference_picture<3>(const Image<float, 3>&, const Image<float, 3>&,
                                       const Image<float, 3>&, const Mask<3>*);
template Picture jacobian_picture<2>(const Image<float, 2>&);
template Picture jacobian_picture<3>(const Image<float, 3>&);
template Picture strain_picture<2>(const Image<float, 2>&);
template Picture strain_picture<3>(const Image<float, 3>&);

}  // namespace crease

#include "Applications/Report/ReportStacks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "Applications/Report/ReportPlaces.h"
#include "Images/IntensityRange.h"
#include "Images/RasterCheck.h"
#include "Registration/Evaluation.h"
#include "Registration/PicturesLines.h"

namespace crease {
namespace {

constexpr int kLayers = 8;  // of a page, further channels apart
constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

/// Pixels from the 1 % to the 99 % percentile, as in the pictures.
template <int Dim>
ReportScale window(Image<float, Dim> image) {
  for (float& v : image.values()) {
    if (!std::isfinite(v)) v = 0;
  }
  const IntensityRange range = intensity_percentiles(image);
  return grey_scale(range.lower, range.upper, "intensity");
}

template <int Dim>
Image<float, Dim> difference(const Image<float, Dim>& a, const Image<float, Dim>& b) {
  Image<float, Dim> result(a.raster());
  std::ranges::transform(a.values(), b.values(), result.values().begin(), std::minus<>());
  return result;
}

template <int Dim>
Image<float, Dim> within(const Image<float, Dim>& image, const Mask<Dim>& mask) {
  Image<float, Dim> result = image;
  for (std::size_t n = 0; n < mask.values().size(); ++n) {
    if (!mask.values()[n]) result.values()[n] = kNoValue;
  }
  return result;
}

/// What layers show, slice by slice: an image, the difference of two, an image within a mask. The images must
/// stay alive.
template <int Dim>
auto samples_of(const Image<float, Dim>& image) {
  return [&image](const Slice<Dim>& slice) { return samples(image, slice); };
}

template <int Dim>
auto difference_of(const Image<float, Dim>& a, const Image<float, Dim>& b) {
  return [&](const Slice<Dim>& slice) { return difference(samples(a, slice), samples(b, slice)); };
}

template <int Dim>
auto samples_within(const Mask<Dim>& mask, const Image<float, Dim>& image) {
  return
      [&](const Slice<Dim>& slice) { return within(samples(image, slice), samples(mask, slice)); };
}

template <int Dim>
std::string text_of(const Point<Dim>& point) {
  std::string text = "(";
  for (int a = 0; a < Dim; ++a) text += fmt::format("{}{:.1f}", a > 0 ? ", " : "", point[a]);
  return text + ") mm";
}

/// One empty drawing per slice.
template <int Dim>
std::vector<std::vector<ReportOverlay::Drawing>> empty_drawings(const ReportPlanes<Dim>& planes) {
  std::vector<std::vector<ReportOverlay::Drawing>> drawings;
  for (int p = 0; p < planes.num_planes(); ++p) drawings.emplace_back(planes.slices(p).size());
  return drawings;
}

/// A mark where a point lies, in the slice of each plane that comes nearest.
template <int Dim>
void add_mark(const ReportPlanes<Dim>& planes, const Point<Dim>& at, bool ring,
              const std::string& label, ReportOverlay& overlay) {
  for (int p = 0; p < planes.num_planes(); ++p) {
    if (const auto spot = planes.spot(p, at)) {
      overlay.drawing(p, spot->slice).marks.push_back({spot->pixel, ring, label});
    }
  }
}

/// Numbers for so few landmarks that they can be read.
std::string landmark_label(int number, int count) {
  constexpr int kMostLabels = 60;
  return count <= kMostLabels ? std::to_string(number + 1) : "";
}

}  // namespace

template <int Dim>
ReportStacks<Dim>::ReportStacks(StackSources<Dim> sources)
    : sources_(std::move(sources)),
      fixed_(sources_.fixed.raster(), kLayers + 2 * static_cast<int>(sources_.channels.size()) +
                                          static_cast<int>(sources_.maps.size())) {
  if (!same_raster(fixed_.raster, sources_.moving.raster())) {
    moving_.emplace(sources_.moving.raster(), kLayers);
  }
  add_images();
  if (sources_.equal_intensities) add_differences();
  add_maps();
  add_outlines();
  add_deformation();
}

template <int Dim>
int ReportStacks<Dim>::add_layer(Stack& stack, const std::string& name, const ReportScale& scale,
                                 const SamplesOfSlice& samples) {
  const int layer = static_cast<int>(stack.shown.layers.size());
  stack.shown.layers.push_back({name, scale, {}});
  jobs_.push_back([&stack, layer, samples] {
    ReportLayer& to = stack.shown.layers[static_cast<std::size_t>(layer)];
    to.png = stack.planes.encode(samples, to.scale);
  });
  return layer;
}

template <int Dim>
int ReportStacks<Dim>::add_overlay(Stack& stack, const std::string& name, ReportOverlay::Look look,
                                   const std::function<void(ReportOverlay&)>& draw) {
  const int overlay = static_cast<int>(stack.shown.overlays.size());
  stack.shown.overlays.push_back({name, look, empty_drawings(stack.planes)});
  jobs_.push_back(
      [&stack, overlay, draw] { draw(stack.shown.overlays[static_cast<std::size_t>(overlay)]); });
  return overlay;
}

template <int Dim>
void ReportStacks<Dim>::add_images() {
  const ReportScale fixed = window(sources_.fixed);
  const ReportScale moving = sources_.equal_intensities ? fixed : window(sources_.moving);
  greys_ = {add_layer(fixed_, "fixed", fixed, samples_of(sources_.fixed)),
            add_layer(fixed_, "warped", moving, samples_of(sources_.warped)),
            add_layer(fixed_, "moving, before", moving, samples_of(sources_.before))};
  for (std::size_t c = 0; c < sources_.channels.size(); ++c) {
    const std::string name = fmt::format(", channel {}", c + 2);
    const auto& channel = sources_.channels[c];
    greys_.push_back(
        add_layer(fixed_, "fixed" + name, window(channel.fixed), samples_of(channel.fixed)));
    greys_.push_back(
        add_layer(fixed_, "warped" + name, window(channel.moving), samples_of(channel.warped)));
  }
}

template <int Dim>
void ReportStacks<Dim>::add_differences() {
  const ReportScale scale = report_scale(
      difference_scale(difference(sources_.before, sources_.fixed)), "difference of intensities");
  differences_ = {add_layer(fixed_, "before: moving \u2212 fixed", scale,
                            difference_of(sources_.before, sources_.fixed)),
                  add_layer(fixed_, "after: warped \u2212 fixed", scale,
                            difference_of(sources_.warped, sources_.fixed))};
}

template <int Dim>
void ReportStacks<Dim>::add_maps() {
  ReportScale determinants = report_scale(
      determinant_scale(
          summarize_determinants(within(sources_.images.determinants, sources_.images.domain))),
      "det \u2207T, no unit: 1 keeps area");
  if (Dim == 3) determinants.label = "det \u2207T, no unit: 1 keeps volume";
  determinants.first = 2;
  determinants.special = "folded";
  determinants.special_colour = "#39ff14";
  const ReportScale strain =
      report_scale(strain_scale(within(sources_.images.strain, sources_.images.domain)),
                   "|E|, no unit: 0 is rigid");
  maps_ = {add_layer(fixed_, "Jacobian determinant", determinants,
                     samples_within(sources_.images.domain, sources_.images.determinants)),
           add_layer(fixed_, "strain", strain,
                     samples_within(sources_.images.domain, sources_.images.strain))};
  for (const auto& map : sources_.maps) {
    maps_.push_back(add_layer(fixed_, map.name, map.scale, samples_of(map.image)));
  }
  fixed_.shown.overlays.push_back(
      {"extreme places", ReportOverlay::Look::kPlace, empty_drawings(fixed_.planes)});
  places_overlay_ = static_cast<int>(fixed_.shown.overlays.size()) - 1;
  jobs_.push_back([this] { find_places(); });
}

template <int Dim>
void ReportStacks<Dim>::find_places() {
  ReportOverlay& overlay = fixed_.shown.overlays[static_cast<std::size_t>(places_overlay_)];
  const auto add = [&](const Image<float, Dim>& image, bool largest, const char* what) {
    constexpr int kCount = 2;
    for (const auto& extreme : extremes(image, sources_.images.domain, largest, kCount)) {
      const std::string number = std::to_string(places_.size() + 1);
      ReportPlace place{
          fmt::format("{}: {} {:.4g} at {}", number, what, extreme.value, text_of<Dim>(extreme.at)),
          {}};
      for (int p = 0; p < fixed_.planes.num_planes(); ++p) {
        place.slices.push_back(fixed_.planes.spot(p, extreme.at)->slice);
      }
      places_.push_back(place);
      add_mark(fixed_.planes, extreme.at, true, number, overlay);
    }
  };
  add(sources_.images.determinants, false, "small determinant");
  add(sources_.images.determinants, true, "large determinant");
  add(sources_.images.strain, true, "strain");
}

template <int Dim>
void ReportStacks<Dim>::draw_features(const Stack& stack, const PointMap<Dim>& map,
                                      ReportOverlay& overlay) const {
  if constexpr (Dim == 2) {
    const Slice<2>& slice = stack.planes.slices(0).front();
    for (const FeatureLine& line : sources_.lines) {
      for (auto& part : mapped_line(slice, stack.raster, map, closed_points(line))) {
        overlay.drawing(0, 0).lines.push_back(std::move(part));
      }
    }
  }
}

template <int Dim>
void ReportStacks<Dim>::add_outlines() {
  if (!sources_.lines.empty()) {
    outlines_.push_back(
        add_overlay(fixed_, "feature lines", ReportOverlay::Look::kFeature, [this](auto& overlay) {
          draw_features(
              fixed_, [](const Point<Dim>& x) { return x; }, overlay);
        }));
  }
  if (!sources_.landmarks.empty()) {
    landmarks_.push_back(
        add_overlay(fixed_, "landmarks", ReportOverlay::Look::kLandmark, [this](auto& overlay) {
          for (int j = 0; j < sources_.landmarks.size(); ++j) {
            add_mark(fixed_.planes, sources_.landmarks.fixed[static_cast<std::size_t>(j)], false,
                     landmark_label(j, sources_.landmarks.size()), overlay);
          }
        }));
  }
}

/// In 3D, with so many more lines, read off the displacement; in 2D that need not be there any more.
template <int Dim>
PointMap<Dim> ReportStacks<Dim>::grid_map() const {
  if constexpr (Dim == 3) return displacement_map(sources_.images.displacement);
  return [this](const Point<Dim>& x) { return sources_.transform.map(x); };
}

template <int Dim>
void ReportStacks<Dim>::draw_grid(const Stack& stack, ReportOverlay& overlay) const {
  constexpr int kLines = Dim == 2 ? 32 : 20;
  const Raster<Dim>& fixed = fixed_.raster;
  const PointMap<Dim> map = grid_map();
  for (int p = 0; p < stack.planes.num_planes(); ++p) {
    const auto& slices = stack.planes.slices(p);
    for (std::size_t s = 0; s < slices.size(); ++s) {
      const Slice<Dim>& slice = slices[s];
      double depth = 0;
      if constexpr (Dim == 3) {  // where the other raster's slice lies, as a share of its sides
        const int across = 3 - slice.first - slice.second;
        depth = (slice.middle[across] + 0.5) / stack.raster.size[across] * fixed.size[across] - 0.5;
      }
      const double step = std::max(slice.width, slice.height) / (Dim == 2 ? 150.0 : 36.0);
      for (const auto& line : grid_lines(fixed, slice, kLines, depth)) {
        for (auto& part : mapped_line(slice, stack.raster, map, line, step)) {
          overlay.drawing(p, static_cast<int>(s)).lines.push_back(std::move(part));
        }
      }
    }
  }
}

template <int Dim>
void ReportStacks<Dim>::add_deformation() {
  Stack& stack = moving_ ? *moving_ : fixed_;
  deformed_layer_ =
      moving_ ? add_layer(stack, "moving", window(sources_.moving), samples_of(sources_.moving))
              : greys_[2];
  deformed_overlays_ = {add_overlay(stack, "deformed grid", ReportOverlay::Look::kGrid,
                                    [this, &stack](auto& overlay) { draw_grid(stack, overlay); })};
  const PointMap<Dim> map = [this](const Point<Dim>& x) { return sources_.transform.map(x); };
  if (!sources_.lines.empty()) {
    deformed_overlays_.push_back(
        add_overlay(stack, "feature lines", ReportOverlay::Look::kFeature,
                    [this, &stack, map](auto& overlay) { draw_features(stack, map, overlay); }));
  }
  if (sources_.landmarks.empty()) return;
  deformed_overlays_.push_back(
      add_overlay(stack, "landmarks (ring: given, cross: mapped)", ReportOverlay::Look::kLandmark,
                  [this, &stack](auto& overlay) { draw_landmarks(stack, overlay); }));
}

/// Where T carries a fixed landmark is drawn in the slice of its partner.
template <int Dim>
void ReportStacks<Dim>::draw_landmarks(const Stack& stack, ReportOverlay& overlay) const {
  const Landmarks<Dim>& landmarks = sources_.landmarks;
  for (int p = 0; p < stack.planes.num_planes(); ++p) {
    for (int j = 0; j < landmarks.size(); ++j) {
      const auto n = static_cast<std::size_t>(j);
      const auto given = stack.planes.spot(p, landmarks.moving[n]);
      if (!given) continue;
      auto& marks = overlay.drawing(p, given->slice).marks;
      marks.push_back({given->pixel, true, landmark_label(j, landmarks.size())});
      const auto mapped = stack.planes.spot(p, sources_.transform.map(landmarks.fixed[n]));
      if (mapped) marks.push_back({mapped->pixel, false, ""});
    }
  }
}

template <int Dim>
void ReportStacks<Dim>::add_to(HtmlReport& report) {
  const int fixed = report.add_stack(std::move(fixed_.shown));
  const int moving = moving_ ? report.add_stack(std::move(moving_->shown)) : fixed;
  using Kind = ReportViewer::Kind;
  std::vector<int> both = outlines_;
  both.insert(both.end(), landmarks_.begin(), landmarks_.end());
  report.begin_section("compare", "Compare");
  report.add_viewer({.kind = Kind::kCompare,
                     .stack = fixed,
                     .title = "Fixed, moving and warped image",
                     .layers = greys_,
                     .more_overlays = both,
                     .note =
                         "Swipe: structures must run on across the divider. Flicker: what "
                         "jumps does not match. Hatched: the moving image has no value there."});
  report.begin_section("difference", "Difference");
  if (differences_.empty()) {
    report.add_text(
        "Intensities of the two images mean different things under this metric, so that "
        "their difference would say nothing; compare them by the checkerboard.");
  } else {
    report.add_viewer(
        {.stack = fixed,
         .title = "Differences before and after, in one scale",
         .layers = differences_,
         .overlays = outlines_,
         .more_overlays = landmarks_,
         .contrast = true,
         .note =
             "What is left after should look like noise. A pair of blue and red along an edge is "
             "a shift; a patch of one colour is a change of intensity, which no map can mend."});
  }
  report.begin_section("deformation", "Deformation");
  report.add_viewer({.stack = moving,
                     .title = "The fixed image's square grid, carried by T onto the moving image",
                     .layers = {deformed_layer_},
                     .overlays = deformed_overlays_,
                     .note = "Rigid bodies keep their squares; lines may bend sharply at feature "
                             "lines and should be smooth elsewhere."});
  report.begin_section("jacobian", "Jacobian and strain");
  std::vector<int> overlays = outlines_;
  overlays.push_back(places_overlay_);
  report.add_viewer(
      {.stack = fixed,
       .title = "How much T grows, shrinks and strains tissue",
       .layers = maps_,
       .overlays = overlays,
       .more_overlays = landmarks_,
       .places = places_,
       .note = "det \u2207T: blue shrinks and red grows from the fixed to the moving image, below "
               "0 the "
               "map folds. |E|: size of the Green strain \u00bd(\u2207T\u1d40\u2207T \u2212 1)."});
}

template class ReportStacks<2>;
template class ReportStacks<3>;

}  // namespace crease

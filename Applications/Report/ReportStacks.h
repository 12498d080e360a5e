#pragma once

#include <functional>
#include <string>
#include <vector>

#include "Applications/Report/HtmlReport.h"
#include "Applications/Report/ReportPlanes.h"
#include "Applications/TransformImages.h"
#include "Registration/Landmarks.h"
#include "Transforms/Domains/FeatureLine.h"

namespace crease {

/// What the pixels of a registration's report are made of: all of it must stay alive.
template <int Dim>
struct StackSources {
  /// A further pair of images.
  struct Channel {
    const Image<float, Dim>& fixed;
    const Image<float, Dim>& moving;
    const Image<float, Dim>& warped;
  };
  /// A further map beside determinants and strain, on the fixed raster; NaN: no value.
  struct Map {
    std::string name;
    const Image<float, Dim>& image;
    ReportScale scale;
  };
  const Image<float, Dim>& fixed;
  const Image<float, Dim>& moving;
  const Image<float, Dim>& warped;     ///< moving(T(x)) on the fixed raster
  const Image<float, Dim>& before;     ///< moving(x)
  const TransformImages<Dim>& images;  ///< of T; in 2D without the displacement
  const Transform<Dim>& transform;     ///< T, into the moving image
  const Landmarks<Dim>& landmarks;
  std::vector<FeatureLine> lines = {};  ///< 2D
  bool equal_intensities = true;        ///< the difference of both images says something
  std::vector<Channel> channels = {};
  std::vector<Map> maps = {};
};

/// The pixels of a registration's report: fixed, moving and warped image, their differences, determinants
/// and strain on the fixed raster, and the grid that T deforms over the moving image.
///
/// They are made by jobs, which depend on nothing but what is passed in and may run in parallel with others.
template <int Dim>
class ReportStacks {
 public:
  explicit ReportStacks(StackSources<Dim> sources);
  ReportStacks(const ReportStacks&) = delete;
  ReportStacks& operator=(const ReportStacks&) = delete;

  /// To be run once each, in any order.
  const std::vector<std::function<void()>>& jobs() const { return jobs_; }
  /// After the jobs, once: sections that show the pixels.
  void add_to(HtmlReport& report);

 private:
  using SamplesOfSlice = typename ReportPlanes<Dim>::SamplesOfSlice;
  static constexpr int kFixedStack = 0, kMovingStack = 1;
  struct Stack {
    Stack(const Raster<Dim>& on, int num_layers) : raster(on), planes(on, num_layers) {
      shown.planes = planes.planes();
      shown.note = planes.note();
    }
    Raster<Dim> raster;
    ReportPlanes<Dim> planes;
    ReportStack shown;
  };

  /// @return the layer's number; its pixels are made by a job.
  int add_layer(Stack& stack, const std::string& name, const ReportScale& scale,
                const SamplesOfSlice& samples);
  /// @return the overlay's number. The drawings are made by a job.
  int add_overlay(Stack& stack, const std::string& name, ReportOverlay::Look look,
                  const std::function<void(ReportOverlay&)>& draw);
  void add_images();
  void add_differences();
  void add_maps();
  void add_outlines();
  void add_deformation();
  void find_places();
  PointMap<Dim> grid_map() const;
  void draw_grid(const Stack& stack, ReportOverlay& overlay) const;
  void draw_landmarks(const Stack& stack, ReportOverlay& overlay) const;
  void draw_features(const Stack& stack, const PointMap<Dim>& map, ReportOverlay& overlay) const;

  const StackSources<Dim> sources_;
  Stack fixed_;
  std::optional<Stack> moving_;  // where the moving image lies on a raster of its own
  std::vector<int> greys_, differences_, maps_;  // layers of the fixed stack
  std::vector<int> outlines_, landmarks_;        // overlays of the fixed stack
  int places_overlay_ = 0;
  int deformed_layer_ = 0;  // of the stack that shows the deformed grid
  std::vector<int> deformed_overlays_;
  std::vector<ReportPlace> places_;
  std::vector<std::function<void()>> jobs_;
};

extern template class ReportStacks<2>;
extern template class ReportStacks<3>;

}  // namespace crease

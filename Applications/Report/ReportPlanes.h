#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "Applications/Report/ReportFigures.h"
#include "Images/Image.h"
#include "Registration/PicturesScales.h"
#include "Registration/PicturesSlices.h"

namespace crease {

/// Which of a raster's slices a report shows, and how large: the whole image (2D), or slices across each
/// axis (3D), so few and so small that all layers of a page stay within some 15 MB.
template <int Dim>
class ReportPlanes {
 public:
  /// An image's samples in a slice (PicturesSlices.h).
  using SamplesOfSlice = std::function<Image<float, 2>(const Slice<Dim>&)>;
  /// A slice of a plane, and a point's place in its pixels.
  struct Spot {
    int slice = 0;
    Point<2> pixel = Point<2>::Zero();
  };

  /// @param num_layers  of the page.
  explicit ReportPlanes(const Raster<Dim>& raster, int num_layers = 8);

  std::vector<ReportPlane> planes() const;
  int num_planes() const { return static_cast<int>(slices_.size()); }
  /// The slices of a plane, sized as shown.
  const std::vector<Slice<Dim>>& slices(int plane) const {
    return slices_[static_cast<std::size_t>(plane)];
  }
  /// What was left out or shrunk; empty if nothing was.
  std::string note() const;
  /// Where a point in mm is seen in a plane; none beyond the raster's edges.
  std::optional<Spot> spot(int plane, const Point<Dim>& point) const;
  /// One PNG per plane. Shrunk pixels are the means of what they cover, but special where one sample is.
  std::vector<std::string> encode(const SamplesOfSlice& samples, const ReportScale& scale) const;

 private:
  int axis(int plane) const;  // across the slices

  Raster<Dim> raster_;
  std::vector<std::vector<Slice<Dim>>> slices_;
};

/// Grey from black to white.
ReportScale grey_scale(double lower, double upper, const std::string& label);
/// The colours of a picture's scale.
ReportScale report_scale(const ColourScale& scale, const std::string& label);

extern template class ReportPlanes<2>;
extern template class ReportPlanes<3>;

}  // namespace crease

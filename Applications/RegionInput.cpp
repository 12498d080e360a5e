#include "Applications/RegionInput.h"

#include <fmt/format.h>

namespace crease {

RegionOfInterest read_region(const std::string& file, const Raster<2>& fixed, InputFiles& input,
                             RunReport& report) {
  RegionOfInterest region = [&] {
    if (has_ending(file, ".csv")) {
      report.add_input("roi", file);
      return read_region_of_interest(file);
    }
    const Mask<2> mask = input.mask<2>("roi", file);
    return region_of_mask(mask.raster(), mask.values());
  }();
  const double outside = share_outside(region, fixed);
  if (outside >= 1) {
    throw InvalidInput(
        message("--roi ", file,
                ": the region lies outside the fixed image; give its points in mm in "
                "the fixed image's space."));
  }
  if (outside > 1e-6) {
    report.add_warning(fmt::format("--roi {}: {:.1f} % of the region lie outside the fixed image.",
                                   file, 100 * outside));
  }
  return region;
}

}  // namespace crease

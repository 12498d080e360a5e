#pragma once

#include <string>

#include "Applications/InputFiles.h"
#include "Transforms/Domains/RegionOfInterest.h"

namespace crease {

/// The region of --roi FILE, a CSV of rings or a mask image; a warning says how much of it lies outside the
/// fixed image.
/// @throws FileError, InvalidInput naming the file, also when all of it does.
RegionOfInterest read_region(const std::string& file, const Raster<2>& fixed, InputFiles& input,
                             RunReport& report);

}  // namespace crease

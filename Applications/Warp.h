#pragma once

#include "Applications/CommandLine.h"

namespace crease {

/// `crease warp`: applies saved transforms to an image, to points or as a displacement field.
Subcommand warp_subcommand();

}  // namespace crease

#pragma once

#include "Applications/CommandLine.h"

namespace crease {

/// `crease phantom`: two images and the map between them, known exactly.
Subcommand phantom_subcommand();

}  // namespace crease

#pragma once

#include "Applications/CommandLine.h"

namespace crease {

/// `crease register`: registers two images.
Subcommand register_subcommand();

}  // namespace crease

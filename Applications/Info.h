#pragma once

#include "Applications/CommandLine.h"

namespace crease {

/// `crease info`: says what a file holds.
Subcommand info_subcommand();

}  // namespace crease

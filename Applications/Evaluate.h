#pragma once

#include "Applications/CommandLine.h"

namespace crease {

/// `crease evaluate`: errors, folds and match of a registration, whoever made it.
Subcommand evaluate_subcommand();

}  // namespace crease

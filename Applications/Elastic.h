#pragma once

#include "Applications/CommandLine.h"

namespace crease {

/// `crease elastic`: carries one mammogram onto another by deforming an elastic breast.
Subcommand elastic_subcommand();

}  // namespace crease

#pragma once

#include <filesystem>
#include <string>

#include "Registration/Phantoms/Phantom.h"
#include "Transforms/Transform.h"

namespace crease::experiments {

/// Writes fixed, moving, warped, grid overlay and Jacobian pictures as NAME_fixed.png, ...
void write_pictures(const std::filesystem::path& folder, const std::string& name,
                    const Phantom& phantom, const Transform<2>& transform);

}  // namespace crease::experiments

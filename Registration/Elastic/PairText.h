#pragma once

#include <string>

#include "Core/Point.h"

// How messages about pairs write lengths and places.
namespace crease {

/// With two decimals: "12.50".
std::string fixed_text(double mm);
/// "(12.50, 3.00) mm".
std::string place_text(const Point<2>& p);

}  // namespace crease

#include "Registration/Elastic/SnapWarnings.h"

#include <algorithm>

#include "Registration/Elastic/PairText.h"

namespace crease {
namespace {

constexpr double kHardly = 0.5;  // mm

}  // namespace

void SnapWarnings::add(const std::string& point, double distance_mm) {
  if (distance_mm > kHardly) {
    clearly_outside_.push_back(point + " lay " + fixed_text(distance_mm) + " mm outside " + body_ +
                               " and was moved onto its border.");
    return;
  }
  ++hardly_outside_;
  farthest_ = std::max(farthest_, distance_mm);
}

std::vector<std::string> SnapWarnings::list() const {
  std::vector<std::string> all = clearly_outside_;
  if (hardly_outside_ == 1) {
    all.push_back("one of the " + points_ + " lay " + fixed_text(farthest_) + " mm outside " +
                  body_ + " and was moved onto its border.");
  } else if (hardly_outside_ > 1) {
    all.push_back(std::to_string(hardly_outside_) + " of the " + points_ + " lay up to " +
                  fixed_text(farthest_) + " mm outside " + body_ +
                  " and were moved onto its border.");
  }
  return all;
}

}  // namespace crease

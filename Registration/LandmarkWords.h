#pragma once

#include <string>
#include <vector>

namespace crease {

/// What messages call landmarks, and what they advise where exact ones contradict each other: the words of
/// whoever reads them.
struct LandmarkWords {
  std::string noun = "landmark";
  std::string remedies =
      "give them a sigma (soft landmarks), use smaller triangles there (--landmarks-conflict "
      "refine, or --mesh-size), or accept the least-squares compromise (--landmarks-conflict "
      "compromise)";

  /// "landmark 3", counted from 1 as in files.
  std::string one(int number) const { return noun + " " + std::to_string(number + 1); }
  /// "landmarks 3, 4 and 9"; "and 25 more" ends a long list.
  std::string listed(const std::vector<int>& numbers) const;
};

}  // namespace crease

#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "Applications/Option.h"
#include "Applications/PhantomFiles.h"
#include "Registration/Phantoms/MammogramPhantom.h"

namespace crease {

/// The options of `crease phantom` that only mammograms have.
struct MammogramCommand {
  std::optional<std::string> view, mass;
  bool temporal = false, bilateral = false, elastic = false, no_label = false;
  std::optional<double> density;
  std::optional<int> bits;

  /// The first that was given, such as "--view"; empty if none was.
  std::string given() const;
};
std::vector<Option> options_of(MammogramCommand& command);

/// What the options ask for; size, seed and noise are left as they are.
/// @throws UsageError when they contradict each other.
MammogramPhantomOptions phantom_options(const MammogramCommand& command);

void write_mammograms(PhantomFiles& files, const MammogramPhantom& phantom, int bits);

/// For phantom.json.
nlohmann::ordered_json mammogram_description(const MammogramPhantom& phantom,
                                             const MammogramPhantomOptions& options);

}  // namespace crease

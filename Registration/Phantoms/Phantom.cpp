#include "Registration/Phantoms/Phantom.h"

#include <array>
#include <cmath>

#include "Core/Error.h"

namespace crease {
namespace {

struct Kind {
  const char* name;
  int default_size;
  Phantom (*make)(const PhantomOptions&);
};

constexpr std::array<Kind, 4> kKinds = {{{"square", 400, make_square_phantom},
                                         {"bodies", 400, make_bodies_phantom},
                                         {"spine", 512, make_spine_phantom},
                                         {"blobs", 256, make_blobs_phantom}}};

constexpr int kDefaultVolumeSize = 96;

void check(const PhantomOptions& options, int smallest, int largest) {
  if (options.size < smallest || options.size > largest) {
    throw InvalidInput(message("phantom: size ", options.size, " is not in ", smallest, " .. ",
                               largest, " pixels"));
  }
  const double noise = options.noise.value_or(0);
  if (!(noise >= 0 && noise <= 0.5)) {
    throw InvalidInput(message("phantom: noise ", noise, " is not in 0 .. 0.5"));
  }
  const double landmark_noise = options.landmark_noise_mm;
  if (!(landmark_noise >= 0 && landmark_noise <= options.size)) {
    throw InvalidInput(message("phantom: landmark noise ", landmark_noise, " mm is not in 0 .. ",
                               options.size, " mm"));
  }
}

template <int Dim>
void add_common_parameters(PhantomImages<Dim>& phantom, const PhantomOptions& options) {
  phantom.parameters.insert(phantom.parameters.begin(),
                            {{"size", options.size}, {"texture", options.texture}});
}

}  // namespace

const std::vector<std::string>& phantom_kinds() {
  static const std::vector<std::string> all_names = [] {
    std::vector<std::string> names;
    for (const auto& kind : kKinds) names.emplace_back(kind.name);
    return names;
  }();
  return all_names;
}

Phantom make_phantom(const std::string& kind, const PhantomOptions& options) {
  for (const auto& known : kKinds) {
    if (kind != known.name) continue;
    PhantomOptions full = options;
    if (full.size == 0) full.size = known.default_size;
    check(full, 64, 4096);
    Phantom phantom = known.make(full);
    add_common_parameters(phantom, full);
    return phantom;
  }
  std::string names;
  for (const auto& known : kKinds) names += (names.empty() ? "" : ", ") + std::string(known.name);
  throw InvalidInput(message("phantom: there is no kind '", kind, "'; choose one of ", names));
}

VolumePhantom make_volume_phantom(const std::string& kind, const PhantomOptions& options) {
  if (kind != "blobs") {
    throw InvalidInput(
        message("phantom: the kind '", kind, "' is for images in 2D; in 3D there is blobs"));
  }
  PhantomOptions full = options;
  if (full.size == 0) full.size = kDefaultVolumeSize;
  check(full, 16, 512);
  VolumePhantom phantom = make_blobs_volume_phantom(full);
  add_common_parameters(phantom, full);
  return phantom;
}

}  // namespace crease

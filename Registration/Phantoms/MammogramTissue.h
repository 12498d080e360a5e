#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "Registration/Phantoms/MammogramDucts.h"
#include "Registration/Phantoms/PowerLawTexture.h"

namespace crease {

/// A tumour: a Gaussian of deviation radius / 2.
struct MammogramMass {
  Point<2> center = Point<2>::Zero();  ///< fixed image, units of the frame's width
  double radius = 0;                   ///< the same; 4 to 12 mm
};
/// In the gland, 4 to 12 mm in radius.
MammogramMass draw_mass(std::uint64_t seed);

/// What of a breast is to be seen.
struct MammogramTissueOptions {
  std::uint64_t seed = 1;
  int size = 1024;            ///< pixels along the frame's width
  double density = 0.5;       ///< 0 fatty, 1 dense
  bool pectoral = true;       ///< the muscle, as in MLO views
  bool other_breast = false;  ///< its textures, and its ducts (draw_ducts)
};

/// Grey of the breast's tissue over that of the film, as a function of the place in the fixed image:
///
///     0.34 t + G t (0.16 + 0.06 N3) (0.3 + density) + 0.02 t N3 + 0.007 t N1.5
///     + 0.22 t (pectoral muscle, edge blurred by 0.5 mm) + 0.10 t (ducts, blurred by 0.8 pixels)
///     + 0.15 t (mass),
///
/// t the thickness, G = exp(-(((x - 0.28) / 0.17)^2 + ((y - 0.52) / 0.20)^2)^1.5) the gland, and N_b
/// random fields of deviation 1 with power spectrum f^-b, b = 3 and 1.5, from 1.5 cycles per frame
/// upwards. All but N_b are formulas. These are cubic splines through values at the fixed image's pixels
/// (PowerLawTexture).
class MammogramTissue {
 public:
  explicit MammogramTissue(const MammogramTissueOptions& options);

  /// The same tissue with a mass or without one. Textures and ducts are shared, not copied.
  MammogramTissue with_mass(const std::optional<MammogramMass>& mass) const;

  const std::vector<Duct>& ducts() const { return parts_->ducts; }
  /// Grey over that of the film; 0 beyond the skin.
  /// @param x      in units of the frame's width.
  /// @param depth  skin_depth(x).
  double grey(const Point<2>& x, double depth) const;

 private:
  struct Parts {
    std::vector<Duct> ducts;
    DuctDrawing drawing;
    PowerLawTexture<2> coarse, fine;  // N3, N1.5
  };
  MammogramTissueOptions options_;
  std::shared_ptr<const Parts> parts_;
  std::optional<MammogramMass> mass_;
};

}  // namespace crease

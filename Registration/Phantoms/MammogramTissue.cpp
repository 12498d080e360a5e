#include "Registration/Phantoms/MammogramTissue.h"

#include <cmath>
#include <numbers>

#include "Registration/Phantoms/MammogramOutline.h"
#include "Registration/Phantoms/MammogramStreams.h"

namespace crease {
namespace {

// Amplitudes fall with half the exponent of the power.
PowerLawTexture<2> make_texture(const MammogramTissueOptions& options, double power_exponent,
                                MammogramStream stream) {
  constexpr double kLowestCycles = 1.5;
  return {static_cast<double>(options.size), 0.5 * power_exponent, 0,
          mammogram_random(options.seed, stream), kLowestCycles / options.size};
}

double gland(const Point<2>& x) {
  const double a = (x.x() - 0.28) / 0.17, b = (x.y() - 0.52) / 0.20;
  const double r2 = a * a + b * b;
  return std::exp(-r2 * std::sqrt(r2));
}

double pectoral_coverage(const Point<2>& x) {
  constexpr double kBlur = 0.5 / kMammogramWidthMm;
  return 0.5 * (1 + std::erf(pectoral_depth(x) / (kBlur * std::numbers::sqrt2)));
}

double mass_grey(const MammogramMass& mass, const Point<2>& x) {
  const double deviation = 0.5 * mass.radius;
  return std::exp(-0.5 * (x - mass.center).squaredNorm() / (deviation * deviation));
}

}  // namespace

MammogramMass draw_mass(std::uint64_t seed) {
  Random random = mammogram_random(seed, MammogramStream::kMass);
  MammogramMass mass;
  mass.center = {0.28 + random.uniform(-0.1, 0.1), 0.52 + random.uniform(-0.12, 0.12)};
  mass.radius = random.uniform(4, 12) / kMammogramWidthMm;
  return mass;
}

MammogramTissue::MammogramTissue(const MammogramTissueOptions& options) : options_(options) {
  const auto texture = [&](double exponent, MammogramStream own, MammogramStream other) {
    return make_texture(options, exponent, options.other_breast ? other : own);
  };
  const std::vector<Duct> ducts = draw_ducts(options.seed, options.other_breast);
  parts_ = std::make_shared<const Parts>(
      Parts{ducts, DuctDrawing(ducts, 0.8 / options.size),
            texture(3, MammogramStream::kCoarseTexture, MammogramStream::kOtherCoarseTexture),
            texture(1.5, MammogramStream::kFineTexture, MammogramStream::kOtherFineTexture)});
}

MammogramTissue MammogramTissue::with_mass(const std::optional<MammogramMass>& mass) const {
  MammogramTissue result = *this;
  result.mass_ = mass;
  return result;
}

double MammogramTissue::grey(const Point<2>& x, double depth) const {
  if (depth <= 0) return 0;
  const Point<2> pixel = options_.size * x;
  const double coarse = parts_->coarse(pixel), fine = parts_->fine(pixel);
  double grey = 0.34 + gland(x) * (0.16 + 0.06 * coarse) * (0.3 + options_.density);
  grey += 0.02 * coarse + 0.007 * fine + 0.10 * parts_->drawing.coverage(x);
  if (options_.pectoral) grey += 0.22 * pectoral_coverage(x);
  if (mass_) grey += 0.15 * mass_grey(*mass_, x);
  return breast_thickness(depth) * grey;
}

}  // namespace crease

#include "Registration/Phantoms/MammogramPhantom.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Registration/Elastic/LoadSteps.h"
#include "Registration/Phantoms/MammogramBody.h"
#include "Registration/Phantoms/MammogramFilm.h"
#include "Registration/Phantoms/MammogramOutline.h"
#include "Registration/Phantoms/MammogramStreams.h"
#include "Registration/Phantoms/MammogramTissue.h"
#include "Registration/Phantoms/MammogramTruth.h"
#include "Registration/Phantoms/PhantomParts.h"

namespace crease {
namespace {

constexpr double kSmallestDeterminant = 0.4;

void check(const MammogramPhantomOptions& options) {
  const auto check_range = [](const char* name, double value, double lower, double upper) {
    if (value >= lower && value <= upper) return;
    throw InvalidInput(
        message("mammogram phantom: ", name, ' ', value, " is not in ", lower, " .. ", upper));
  };
  check_range("size", options.size, 128, 4096);
  check_range("density", options.density, 0, 1);
  check_range("noise", options.noise, 0, 0.5);
  if (options.elastic && options.further) {
    throw InvalidInput(
        "mammogram phantom: an elastic body moves by itself; leave out the further map");
  }
  if (options.bits != 8 && options.bits != 12 && options.bits != 16) {
    throw InvalidInput(
        message("mammogram phantom: ", options.bits, " bits per pixel; choose 8, 12 or 16"));
  }
}

Raster<2> frame_raster(int size) {
  Raster<2> raster;
  raster.size.fill(size);
  raster.spacing.setConstant(kMammogramWidthMm / size);
  return raster;
}

struct CheckedMotion {
  MammogramDeformation deformation;
  std::pair<double, double> determinants;
};

// A motion of the tissue, and its determinants.
CheckedMotion checked(const MammogramMotion& motion,
                      std::shared_ptr<const Transform<2>> further = nullptr) {
  MammogramDeformation deformation(motion, std::move(further));
  const auto determinants = deformation.determinant_range();
  return {std::move(deformation), determinants};
}

// Determinants also at the points of quadrature. Nothing if there is no equilibrium.
std::optional<CheckedMotion> follow(const MammogramBody& body, const MammogramMotion& motion) {
  try {
    const auto equilibrium = body.follow(motion);
    CheckedMotion result = checked(motion, equilibrium.further);
    double& least = result.determinants.first;
    least = std::min(least, equilibrium.least_determinant);
    return result;
  } catch (const NoEquilibrium&) {
    return std::nullopt;
  }
}

CheckedMotion draw_deformation(const MammogramPhantomOptions& options) {
  constexpr int kMaxHalvings = 10;
  const MammogramMotion drawn =
      draw_mammogram_motion(mammogram_random(options.seed, MammogramStream::kMotion));
  std::optional<MammogramBody> body;
  if (options.elastic)
    body.emplace(MammogramBodyOptions{.muscle = options.view == MammogramView::kMlo});
  for (int halvings = 0; halvings <= kMaxHalvings; ++halvings) {
    const MammogramMotion motion = drawn.scaled(std::ldexp(1.0, -halvings));
    const auto found = body ? follow(*body, motion) : checked(motion, options.further);
    if (found && found->determinants.first > kSmallestDeterminant) return *found;
  }
  if (body) {
    throw SolverError(message("mammogram phantom: under no motion of seed ", options.seed,
                              " the elastic body finds an equilibrium that squeezes no tissue to a "
                              "determinant of ",
                              kSmallestDeterminant, " or less; take another seed"));
  }
  throw InvalidInput(
      message("mammogram phantom: the further map squeezes tissue to a determinant of ",
              kSmallestDeterminant, " or less; make it milder"));
}

MammogramTissue make_tissue(const MammogramPhantomOptions& options, bool other_breast) {
  return MammogramTissue({.seed = options.seed,
                          .size = options.size,
                          .density = options.density,
                          .pectoral = options.view == MammogramView::kMlo,
                          .other_breast = other_breast});
}

// Where each pixel of an image gets its tissue from: a point of the fixed image, mm.
using Sources = Image<Vector<2>, 2>;

Sources fixed_sources(const Raster<2>& raster) {
  Sources sources(raster);
  parallel_for(raster.size[1], [&](std::int64_t j) {
    for (int i = 0; i < raster.size[0]; ++i) {
      sources(i, static_cast<int>(j)) = raster.point(Vector<2>(i, j));
    }
  });
  return sources;
}

// T^-1 of every pixel. Newton starts where the pixel before came from.
Sources moving_sources(const Raster<2>& raster, const MammogramMap& map) {
  Sources sources(raster);
  parallel_for(raster.size[1], [&](std::int64_t j) {
    Point<2> last = map.mirror(raster.point(Vector<2>(0, j)));
    Point<2> start = last;
    for (int i = 0; i < raster.size[0]; ++i) {
      const Point<2> y = map.mirror(raster.point(Vector<2>(i, j)));
      const Point<2> x = map.deformation.inverse(y, start + y - last);
      sources(i, static_cast<int>(j)) = x;
      last = y;
      start = x;
    }
  });
  return sources;
}

// Mask, labels, and the tissue on top of the film.
void expose(const Sources& sources, const MammogramTissue& tissue, MammogramView view,
            Image<double, 2>& film, MammogramImage& image) {
  const Raster<2>& raster = sources.raster();
  image.mask = Mask<2>(raster);
  if (view == MammogramView::kMlo) image.labels = LabelImage<2>(raster);
  parallel_for(raster.size[1], [&](std::int64_t row) {
    const int j = static_cast<int>(row);
    for (int i = 0; i < raster.size[0]; ++i) {
      const Point<2> x = sources(i, j) / kMammogramWidthMm;
      const double depth = skin_depth(x);
      if (depth <= 0) continue;
      image.mask(i, j) = 1;
      if (!image.labels.empty()) image.labels(i, j) = pectoral_depth(x) > 0 ? 1 : 0;
      film(i, j) += tissue.grey(x, depth);
    }
  });
}

struct Development {
  FilmResponse response;
  MammogramStream noise;
};

void take_image(const MammogramPhantomOptions& options, const Sources& sources, bool mirrored,
                const MammogramTissue& tissue, const Development& development,
                MammogramImage& image) {
  Image<double, 2> film = exposed_film(sources.raster(), mirrored, options.label);
  expose(sources, tissue, options.view, film, image);
  blur_film(film);
  apply_response(film, development.response);
  add_film_noise(film, options.noise, mammogram_random(options.seed, development.noise));
  image.pixels = digitised(film, options.bits);
}

void add_mass_parameters(const MammogramMass& mass, MammogramPhantom& phantom) {
  const Point<2> center = kMammogramWidthMm * mass.center, moved = phantom.truth(center);
  phantom.parameters.insert(phantom.parameters.end(),
                            {{"mass_radius_mm", kMammogramWidthMm * mass.radius},
                             {"mass_fixed_x_mm", center.x()},
                             {"mass_fixed_y_mm", center.y()},
                             {"mass_moving_x_mm", moved.x()},
                             {"mass_moving_y_mm", moved.y()}});
}

}  // namespace

MammogramPhantom make_mammogram_phantom(const MammogramPhantomOptions& options) {
  check(options);
  const Raster<2> raster = frame_raster(options.size);
  const bool bilateral = options.pair == MammogramPairKind::kBilateral;
  const auto [deformation, determinants] = draw_deformation(options);
  const MammogramMap map{deformation, bilateral, raster.spacing.x() * (options.size - 1)};
  const FilmResponse response =
      draw_response(mammogram_random(options.seed, MammogramStream::kDevelopment));

  const MammogramMass mass = draw_mass(options.seed);
  const auto mass_in = [&](MammogramMassPlace image) {
    return options.mass == image ? std::optional(mass) : std::nullopt;
  };
  const MammogramTissue tissue = make_tissue(options, false);
  const MammogramTissue fixed_tissue = tissue.with_mass(mass_in(MammogramMassPlace::kFixed));
  const MammogramTissue moving_tissue = (bilateral ? make_tissue(options, true) : tissue)
                                            .with_mass(mass_in(MammogramMassPlace::kMoving));

  MammogramPhantom phantom;
  take_image(options, fixed_sources(raster), false, fixed_tissue,
             {FilmResponse(), MammogramStream::kFixedNoise}, phantom.fixed);
  take_image(options, moving_sources(raster, map), bilateral, moving_tissue,
             {response, MammogramStream::kMovingNoise}, phantom.moving);
  describe_fixed(fixed_tissue.ducts(), options.view, phantom.fixed);
  describe_moving(moving_tissue.ducts(), options.view, map, phantom.moving);
  phantom.truth = map;
  phantom.inverse = [map](const Point<2>& y) { return map.inverse(y); };
  phantom.displacement = displacement_of<2>(raster, map);
  phantom.landmarks = mammogram_landmarks(phantom.fixed, phantom.moving, map);
  phantom.parameters = {{"spacing_mm", raster.spacing.x()},
                        {"gain", response.gain},
                        {"gamma", response.gamma},
                        {"determinant_min", determinants.first},
                        {"determinant_max", determinants.second}};
  const auto motion = motion_parameters(deformation.motion());
  phantom.parameters.insert(phantom.parameters.end(), motion.begin(), motion.end());
  if (options.mass != MammogramMassPlace::kNone) add_mass_parameters(mass, phantom);
  return phantom;
}

}  // namespace crease

#include "Applications/ElasticCommandOptions.h"

#include <algorithm>
#include <charconv>

#include "Applications/ExitCode.h"

namespace crease {
namespace {

constexpr int kMostSteps = 10000;

bool is_count(const std::string& text) {
  int value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end && value >= 1 && value <= kMostSteps;
}

std::vector<Option> input_options(ElasticCommandOptions& o) {
  return {
      {.name = "fixed",
       .target = &o.fixed,
       .placeholder = "FILE",
       .help = "Fixed image, such as the current mammogram: the space that results live in",
       .required = true,
       .is_path = true},
      {.name = "moving",
       .target = &o.moving,
       .placeholder = "FILE",
       .help = "Moving image, such as the previous one: deformed to look like the fixed one",
       .required = true,
       .is_path = true},
      {.name = "output",
       .target = &o.output,
       .placeholder = "DIR",
       .help = "Folder of the results; made if missing",
       .required = true,
       .is_path = true,
       .short_name = "o"},
      {.name = "pairs",
       .target = &o.pairs,
       .placeholder = "FILE",
       .help = "Pairs to be met: CSV fixed_x,fixed_y,moving_x,moving_y in mm; or given twice, two "
               "files "
               "of 3D Slicer, fixed first",
       .is_path = true},
      {.name = "contour-pairs",
       .target = &o.contour_pairs,
       .placeholder = "N",
       .help = "Pairs at equal arc length along both skin lines (40, or none beside --pairs)",
       .minimum = 0,
       .maximum = 1000},
      {.name = "pectoral-pairs",
       .target = &o.pectoral_pairs,
       .placeholder = "N",
       .help = "Pairs on the edge of the pectoral muscle, equally far from the skin in both images "
               "(4 beside pairs along the skin)",
       .minimum = 0,
       .maximum = 1000},
      {.name = "spacing",
       .target = &o.spacing,
       .placeholder = "X,Y",
       .help =
           "Pixel size in mm of images whose files tell none (PNG, JPEG, PGM); otherwise 0.2 for "
           "mammograms, else 1",
       .minimum = 0,
       .open_minimum = true},
      {.name = "truth",
       .target = &o.truth,
       .placeholder = "FILE",
       .help = "True displacement of a phantom, mm: errors are reported before, after the pairs "
               "and after the refinement",
       .is_path = true},
  };
}

std::vector<Option> body_options(ElasticCommandOptions& o) {
  return {
      {.name = "roi",
       .target = &o.roi,
       .placeholder = "FILE",
       .help =
           "The elastic body: the breast as segmented, the whole image, or a file (CSV ring,x,y in "
           "mm, or a mask image)",
       .choices = {"auto", "image"},
       .is_path = true},
      {.name = "regions",
       .target = &o.regions,
       .placeholder = "FILE",
       .help = "Label image of tissues on the fixed grid, 0 breast, k > 0 tissue k (--young, "
               "--poisson); "
               "outlines become creases",
       .is_path = true},
      {.name = "pectoral",
       .target = &o.pectoral,
       .placeholder = "FILE",
       .help =
           "Edge of the pectoral muscle, a crease: searched for, absent, or a CSV line,x,y in mm "
           "(auto "
           "with --roi auto, else none). The muscle has label 1, with --regions one more than the "
           "largest, and ten times the breast's stiffness unless --young says otherwise",
       .choices = {"auto", "none"},
       .is_path = true},
      {.name = "degree",
       .target = &o.degree,
       .placeholder = "N",
       .help = "Degree of the spline",
       .minimum = 1,
       .maximum = 3},
      {.name = "triangles",
       .target = &o.triangles,
       .placeholder = "N",
       .help = "About as many triangles (600)",
       .minimum = 2,
       .maximum = 2e6},
      {.name = "mesh-size",
       .target = &o.mesh_size,
       .placeholder = "MM",
       .help = "Edge length of the triangles, half as long near lines, instead of --triangles",
       .minimum = 0,
       .open_minimum = true},
      {.name = "no-creases",
       .target = &o.no_creases,
       .help = "Keep the mesh, but be smooth across the lines"},
      {.name = "mirror",
       .target = &o.mirror,
       .help =
           "Mirror the moving mammogram: where the chest walls are on different sides, or as told",
       .choices = {"auto", "yes", "no"}},
      {.name = "threshold",
       .target = &o.threshold,
       .placeholder = "GREY",
       .help =
           "Grey value that separates film and breast in both images (found in the histograms)"},
      {.name = "force", .target = &o.force, .help = "Go on where the two views look different"},
  };
}

std::vector<Option> solver_options(ElasticCommandOptions& o) {
  return {
      {.name = "steps",
       .target = &o.steps,
       .placeholder = "N|adaptive",
       .help = "Equal load steps from rest to the pairs, or as few as work"},
      {.name = "corrector",
       .target = &o.corrector,
       .help = "Newton to equilibrium in each load step, or none as the dissertation has it",
       .choices = {"newton", "none"}},
      {.name = "quadrature",
       .target = &o.quadrature,
       .help = "Integrate stored energy in every cell of the knot lines, exactly, or at 12 points "
               "per triangle; how much that is off is reported",
       .choices = {"cells", "cheap"}},
      {.name = "no-refine",
       .target = &o.no_refine,
       .help = "Stop after the pairs: no refinement by the images"},
      {.name = "metric",
       .target = &o.metric,
       .help = "Likeness that refines: sum of squared differences, mutual information, normalised "
               "mutual information, correlation, correlation in windows",
       .choices = {"ssd", "mi", "nmi", "ncc", "lncc"}},
      {.name = "refinement",
       .target = &o.refinement,
       .help = "How the refinement is found; damped as the dissertation has it, slow",
       .choices = {"gauss-newton", "damped"}},
      {.name = "damped-step",
       .target = &o.damped_step,
       .placeholder = "H",
       .help = "Step of the damped iteration, halved where the energy grows",
       .minimum = 0,
       .maximum = 1,
       .open_minimum = true},
      {.name = "alpha-relative",
       .target = &o.alpha_relative,
       .placeholder = "C",
       .help =
           "Weight of the images in the refinement, in units of what balances the traces of both "
           "stiffness matrices (1e-4)",
       .minimum = 0,
       .open_minimum = true},
      {.name = "alpha",
       .target = &o.alpha,
       .placeholder = "A",
       .help = "The same, absolute: energy per mm^2 and squared difference, intensities in units "
               "of the "
               "fixed image's range",
       .minimum = 0,
       .open_minimum = true},
      {.name = "pin",
       .target = &o.pin,
       .help = "What the refinement leaves in place: the body's two ends at the chest wall, or all "
               "pairs "
               "on the contour as well",
       .choices = {"corners", "contour"}},
      {.name = "levels",
       .target = &o.levels,
       .placeholder = "L",
       .help = "Resolutions of the refinement, by factors of two down to the images' own",
       .minimum = 1,
       .maximum = 12},
      {.name = "smoothing",
       .target = &o.smoothing,
       .placeholder = "MM,...",
       .help = "Gaussian that smooths both images, mm, coarsest level first; the last holds on",
       .minimum = 0},
  };
}

void check_refinement(const ElasticCommandOptions& o) {
  const auto refuse = [&](bool given, const char* option) {
    if (given && o.no_refine) {
      throw UsageError(message("--", option, " has no meaning with --no-refine."));
    }
  };
  refuse(o.metric != "ssd", "metric");
  refuse(o.refinement != "gauss-newton", "refinement damped");
  refuse(o.alpha.has_value(), "alpha");
  refuse(o.alpha_relative.has_value(), "alpha-relative");
  refuse(o.pin != "corners", "pin contour");
  const ElasticCommandOptions usual;
  refuse(o.levels != usual.levels, "levels");
  refuse(o.smoothing != usual.smoothing, "smoothing");
  if (o.damped_step != usual.damped_step && o.refinement != "damped") {
    throw UsageError("--damped-step needs --refinement damped.");
  }
  if (o.smoothing.empty()) throw UsageError("--smoothing needs at least one width, such as 1.5.");
}

}  // namespace

std::vector<Option> options_of(ElasticCommandOptions& options) {
  return joined({input_options(options),
                 body_options(options),
                 options_of(options.material),
                 {mean_dilatation_option(options.material)},
                 solver_options(options),
                 options_of(options.run)});
}

void check(const ElasticCommandOptions& o) {
  if (!o.needs_anatomy() && (o.mirror != "auto" || o.threshold || o.force)) {
    throw UsageError(
        "--mirror, --threshold and --force are for mammograms: with --roi auto, --pectoral or "
        "--contour-pairs.");
  }
  if (o.pairs.size() > 2) {
    throw UsageError(
        "--pairs takes one CSV file, or two files of 3D Slicer: the fixed points first.");
  }
  if (o.pairs.empty() && o.num_contour_pairs() == 0) {
    throw UsageError("--contour-pairs 0 leaves nothing to deform by; give --pairs FILE.");
  }
  if (o.num_pectoral_pairs() > 0 && o.pectoral_source() == "none") {
    throw UsageError("--pectoral-pairs needs the muscle: give --pectoral auto or --pectoral FILE.");
  }
  if (o.num_contour_pairs() > 0 && o.num_contour_pairs() < 3) {
    throw UsageError(message("--contour-pairs ", o.num_contour_pairs(), ": take 3 or more."));
  }
  if (o.steps != "adaptive" && !is_count(o.steps)) {
    throw UsageError(
        message("--steps ", o.steps, ": give a number from 1 to ", kMostSteps, ", or `adaptive`."));
  }
  if (o.corrector == "none" && o.steps == "adaptive") {
    throw UsageError("--steps adaptive needs --corrector newton, by which it tells how far to go.");
  }
  check_refinement(o);
  material_of(o.material);  // says what cannot be read
}

}  // namespace crease

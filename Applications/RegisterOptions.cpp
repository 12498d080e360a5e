#include "Applications/RegisterOptions.h"

#include <algorithm>

namespace crease {
namespace {

const std::vector<std::string> kStarts = {"moments", "centres", "landmarks", "identity"};

std::vector<Option> input_options(RegisterOptions& o) {
  return {
      {.name = "fixed",
       .target = &o.fixed,
       .placeholder = "FILE",
       .help = "Fixed image: the space that results live in; given again for each further channel, "
               "with "
               "a --moving of its own",
       .required = true,
       .is_path = true},
      {.name = "moving",
       .target = &o.moving,
       .placeholder = "FILE",
       .help = "Moving image: deformed to look like the fixed one",
       .required = true,
       .is_path = true},
      {.name = "output",
       .target = &o.output,
       .placeholder = "DIR",
       .help = "Folder of the results; made if missing",
       .required = true,
       .is_path = true,
       .short_name = "o"},
      {.name = "fixed-mask",
       .target = &o.fixed_mask,
       .placeholder = "FILE",
       .help = "Image: samples count where it is not 0",
       .is_path = true},
      {.name = "moving-mask",
       .target = &o.moving_mask,
       .placeholder = "FILE",
       .help = "The same in the moving image",
       .is_path = true},
      {.name = "spacing",
       .target = &o.spacing,
       .placeholder = "X,Y[,Z]",
       .help = "Pixel size in mm of images whose files tell none (PNG, JPEG, PGM); otherwise 1",
       .minimum = 0,
       .open_minimum = true},
  };
}

std::vector<Option> domain_options(RegisterOptions& o) {
  return {
      {.name = "transform",
       .target = &o.transform,
       .help = "What moves the image; on triangles and T-splines in 2D only, the others in 3D, too",
       .choices = {"triangular-bspline", "bspline", "nurbs", "powell-sabin", "tspline",
                   "thin-plate", "cauchy-navier", "affine", "similarity", "rigid"}},
      {.name = "degree",
       .target = &o.degree,
       .placeholder = "N",
       .help = "Degree of the spline, 1 to 5 (3)",
       .minimum = 1,
       .maximum = 5},
      {.name = "smoothness",
       .target = &o.smoothness,
       .placeholder = "1|2",
       .help = "Continuous derivatives away from creases (degree - 1)",
       .minimum = 1,
       .maximum = 2},
      {.name = "mesh-size",
       .target = &o.mesh_size,
       .placeholder = "MM",
       .help =
           "Edge length of the triangles, half as long near lines, or of the B-spline's spans (a "
           "twelfth of the longer side)",
       .minimum = 0,
       .open_minimum = true},
      {.name = "triangles",
       .target = &o.triangles,
       .placeholder = "N",
       .help = "About as many triangles, instead of --mesh-size",
       .minimum = 2,
       .maximum = 2e6},
      {.name = "roi",
       .target = &o.roi,
       .placeholder = "FILE",
       .help = "Domain: CSV ring,x,y in mm, or a mask image (the whole image)",
       .is_path = true},
      {.name = "rigid-labels",
       .target = &o.rigid_labels,
       .placeholder = "FILE",
       .help = "Label image, 0 soft, k > 0 rigid body k; outlines become creases",
       .is_path = true},
      {.name = "feature-lines",
       .target = &o.feature_lines,
       .placeholder = "FILE",
       .help = "Creases: CSV line,x,y[,kind,body,corner] in mm, or curves of 3D Slicer",
       .is_path = true},
      {.name = "no-creases",
       .target = &o.no_creases,
       .help = "Keep the mesh, but be smooth across the lines"},
  };
}

std::vector<Option> cost_options(RegisterOptions& o) {
  return {
      {.name = "landmarks",
       .target = &o.landmarks,
       .placeholder = "FILE",
       .help =
           "Pairs: CSV fixed_x,fixed_y,moving_x,moving_y in mm; or given twice, two files of 3D "
           "Slicer, fixed first",
       .is_path = true},
      {.name = "landmarks-mode",
       .target = &o.landmarks_mode,
       .help = "Meet landmarks exactly, or up to their uncertainty",
       .choices = {"exact", "soft"}},
      {.name = "landmarks-sigma",
       .target = &o.landmarks_sigma,
       .placeholder = "MM",
       .help = "Uncertainty of soft landmarks without their own sigma_mm (1)",
       .minimum = 0,
       .open_minimum = true},
      {.name = "landmarks-conflict",
       .target = &o.landmarks_conflict,
       .help = "Exact landmarks that contradict each other: stop, divide the triangles that hold "
               "them, or meet them on average",
       .choices = {"error", "refine", "compromise"}},
      {.name = "metric",
       .target = &o.metric,
       .help = "Likeness: sum of squared differences, mutual information, normalised mutual "
               "information, correlation, correlation in windows, or landmarks alone; once for all "
               "channels, or once for each",
       .choices = {"ssd", "mi", "nmi", "ncc", "lncc", "none"}},
      {.name = "channel-weights",
       .target = &o.channel_weights,
       .placeholder = "W1,W2,...",
       .help = "Weights of the channels in the sum of their metrics (1 each)",
       .minimum = 0},
      {.name = "interpolator",
       .target = &o.interpolator,
       .help = "Between the pixels of the moving image",
       .choices = {"cubic", "linear"}},
      {.name = "alpha",
       .target = &o.alpha,
       .placeholder = "A",
       .help = "Weight of the images",
       .minimum = 0},
      {.name = "beta",
       .target = &o.beta,
       .placeholder = "B",
       .help = "Weight of the rigidity of bodies (1)",
       .minimum = 0},
      {.name = "gamma",
       .target = &o.gamma,
       .placeholder = "G",
       .help =
           "Weight of bending, mm^2 (balanced against the noise that the images show, from 0.001 "
           "times the mean edge length squared on), or of the elastic energy (likewise, from 0.001 "
           "on)",
       .minimum = 0},
      {.name = "energy",
       .target = &o.energy,
       .help = "What smooths the motion: it resists bending, or it deforms an elastic body",
       .choices = {"bending", "elastic"}},
  };
}

std::vector<Option> solver_options(RegisterOptions& o) {
  return {
      {.name = "init",
       .target = &o.init,
       .placeholder = "FILE",
       .help = "Start: centres of mass, of images, fit of landmarks, or an affine transform's file "
               "(landmarks where there are enough, else moments)",
       .choices = kStarts,
       .is_path = true},
      {.name = "init-transform",
       .target = &o.init_transform,
       .help = "Search a rigid, similar or affine map first (none)",
       .choices = {"rigid", "similarity", "affine", "none"}},
      {.name = "levels",
       .target = &o.levels,
       .placeholder = "L",
       .help = "Resolutions of the image pyramid",
       .minimum = 1,
       .maximum = 12},
      {.name = "adapt",
       .target = &o.adapt,
       .placeholder = "N",
       .help = "Divide patches where the images ask for it, up to N times (0)",
       .minimum = 0,
       .maximum = 8},
      {.name = "sample-fraction",
       .target = &o.sample_fraction,
       .placeholder = "F",
       .help =
           "Share of the rows of pixels that all levels but the finest look at, chosen by --seed",
       .minimum = 0,
       .maximum = 1,
       .open_minimum = true},
      {.name = "optimizer",
       .target = &o.optimizer,
       .help = "How the minimum is sought; nelder-mead for rigid and affine maps only",
       .choices = {"gauss-newton", "lbfgs", "conjugate-gradient", "steepest-descent",
                   "nelder-mead"}},
      {.name = "null-space",
       .target = &o.null_space,
       .help = "How exact landmarks are eliminated",
       .choices = {"elimination", "qr", "svd"}},
      {.name = "require-invertible",
       .target = &o.require_invertible,
       .help =
           "Go on from a map that folds until it is certified not to; exit with 1 where that fails "
           "(results are written)"},
  };
}

}  // namespace

std::string RegisterOptions::metric_name() const {
  if (std::ranges::count(metric, metric.front()) == std::ssize(metric)) return metric.front();
  std::string names;
  for (const std::string& name : metric) names += (names.empty() ? "" : "+") + name;
  return names;
}

bool RegisterOptions::init_is_file() const {
  return init && std::ranges::count(kStarts, *init) == 0;
}

std::vector<Option> options_of(RegisterOptions& options) {
  return joined({input_options(options), domain_options(options), cost_options(options),
                 options_of(options.material), solver_options(options), options_of(options.run)});
}

}  // namespace crease

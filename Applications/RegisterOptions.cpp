#include "Applications/RegisterOptions.h"

#include <algorithm>

#include "Applications/ExitCode.h"

namespace crease {
namespace {

const std::vector<std::string> kStarts = {"moments", "centres", "landmarks", "identity"};

std::string times(std::size_t n) { return n == 1 ? "once" : message(n, " times"); }

/// Refuses an option that the transform chosen would ignore.
void refuse_if(bool given, const char* option, const RegisterOptions& options, const char* needs) {
  if (!given) return;
  throw UsageError(message("--", option, " has no meaning with --transform ", options.transform,
                           "; it needs ", needs, "."));
}

void check_transform(const RegisterOptions& o) {
  if (!o.has_triangles()) {
    const char* needs = "triangles: --transform triangular-bspline or powell-sabin";
    refuse_if(o.triangles.has_value(), "triangles", o, needs);
    refuse_if(o.roi.has_value(), "roi", o, needs);
    refuse_if(o.feature_lines.has_value(), "feature-lines", o, needs);
    refuse_if(o.landmarks_conflict == "refine", "landmarks-conflict refine", o, needs);
  }
  if (!o.is_triangular()) {
    const char* needs = "--transform triangular-bspline";
    refuse_if(o.smoothness.has_value(), "smoothness", o, needs);
    refuse_if(o.no_creases, "no-creases", o, needs);
  }
  if (o.transform == "powell-sabin" || o.transform == "thin-plate") {
    refuse_if(o.degree.has_value(), "degree", o, "splines of any degree, such as bspline");
  }
  if (o.transform == "tspline" && o.spline_degree() % 2 == 0) {
    throw UsageError(message("--degree ", o.spline_degree(),
                             ": T-splines have degree 1, 3 or 5; take one of these."));
  }
  refuse_if(o.adapt > 0 && !o.can_adapt(), "adapt", o,
            "patches that can be divided: --transform triangular-bspline, powell-sabin or tspline");
  if (!o.has_basis()) {
    const char* needs = "a spline, such as --transform triangular-bspline or bspline";
    refuse_if(o.degree.has_value(), "degree", o, needs);
    refuse_if(o.rigid_labels.has_value(), "rigid-labels", o, needs);
    refuse_if(o.beta.has_value(), "beta", o, needs);
    refuse_if(o.num_channels() > 1 && !o.is_linear(), "fixed, given twice,", o, needs);
  }
  if (o.is_linear()) {
    const char* needs = "a transform that bends, such as triangular-bspline or bspline";
    refuse_if(o.mesh_size.has_value(), "mesh-size", o, needs);
    refuse_if(o.gamma.has_value(), "gamma", o, needs);
    refuse_if(o.init_transform.has_value(), "init-transform", o, needs);
    refuse_if(o.landmarks_mode != "exact", "landmarks-mode", o, needs);
    refuse_if(o.landmarks_conflict != "error", "landmarks-conflict", o, needs);
    refuse_if(o.sample_fraction != 1, "sample-fraction", o, needs);
    refuse_if(o.null_space != "elimination", "null-space", o, needs);
  }
  if (!o.is_linear() && o.optimizer == "nelder-mead") {
    throw UsageError(
        message("--optimizer nelder-mead is for few unknowns: --transform rigid or "
                "affine. For --transform ",
                o.transform, " take gauss-newton or lbfgs."));
  }
  if (o.smoothness && *o.smoothness > o.spline_degree() - 1) {
    throw UsageError(message("--smoothness ", *o.smoothness, " needs --degree ", *o.smoothness + 1,
                             " or more; the degree is ", o.spline_degree(), "."));
  }
}

void check_energy(const RegisterOptions& o) {
  if (!o.is_elastic()) {
    if (!o.material.any_given()) return;
    throw UsageError(
        "--young, --poisson, --material, --plane and --mean-dilatation describe elastic tissue; "
        "add "
        "--energy elastic.");
  }
  if (!o.has_basis()) {
    refuse_if(true, "energy elastic", o,
              "a spline, such as --transform triangular-bspline or bspline");
  }
  const ElasticMaterial material = material_of(o.material);  // throws
  if (!material.regions.empty() && !o.may_have_bodies()) {
    throw UsageError(
        message("--young, --poisson: region ", material.regions.begin()->first,
                " is named, but there are no labels; add --rigid-labels FILE (with --beta "
                "0 if its regions are not rigid)."));
  }
}

void check_adaptation(const RegisterOptions& o) {
  if (o.adapt == 0) return;
  if (o.is_elastic()) {
    throw UsageError(
        "--adapt needs bending, which says what finer patches cost; leave --energy "
        "elastic out.");
  }
  if (o.image_weight() == 0) throw UsageError("--adapt needs images to ask for finer patches.");
  if (o.gamma && *o.gamma == 0) {
    throw UsageError(
        "--adapt needs bending, which says what finer patches cost; leave --gamma 0 out.");
  }
}

void check_landmarks(const RegisterOptions& o) {
  if (o.landmarks.size() > 2) {
    throw UsageError(
        "--landmarks takes one CSV file, or two files of 3D Slicer: the fixed points "
        "first.");
  }
  const bool has = !o.landmarks.empty();
  const auto needs_landmarks = [&](bool given, const char* option) {
    if (given && !has) throw UsageError(message("--", option, " needs --landmarks FILE."));
  };
  needs_landmarks(o.landmarks_mode != "exact", "landmarks-mode soft");
  needs_landmarks(o.landmarks_conflict != "error", "landmarks-conflict");
  needs_landmarks(o.landmarks_sigma.has_value(), "landmarks-sigma");
  needs_landmarks(o.init == "landmarks", "init landmarks");
  if (o.landmarks_conflict != "error" && o.landmarks_mode == "soft") {
    throw UsageError(
        "--landmarks-conflict is for exact landmarks; soft ones cannot contradict each other.");
  }
  if (o.landmarks_sigma && o.landmarks_mode != "soft") {
    throw UsageError(
        "--landmarks-sigma needs --landmarks-mode soft: exact landmarks have no "
        "uncertainty.");
  }
}

void check_weights(const RegisterOptions& o) {
  if (o.is_linear()) {
    if (!o.has_metric() && o.landmarks.empty()) {
      throw UsageError("--metric none leaves nothing to register by; give --landmarks FILE.");
    }
    return;
  }
  if (o.beta && !o.may_have_bodies()) {
    throw UsageError(
        "--beta weighs rigid bodies, but none are given; add --rigid-labels FILE or "
        "--feature-lines FILE with closed lines.");
  }
  const bool bending = !o.gamma || *o.gamma > 0;
  if (bending && !o.is_elastic() && o.spline_degree() == 1) {
    throw UsageError(
        "--degree 1: such splines have no bending energy; take --degree 2 or more, --energy "
        "elastic, or "
        "--gamma 0.");
  }
  const bool rigidity = o.may_have_bodies() && o.rigidity_weight() > 0;
  if (o.image_weight() == 0 && !bending && !rigidity) {
    throw UsageError(
        "all weights are zero: give at least one of --alpha (with --metric ssd), --beta "
        "and --gamma a value above 0.");
  }
  if (o.image_weight() == 0 && o.landmarks.empty()) {
    throw UsageError(message(o.has_metric() ? "--alpha 0" : "--metric none",
                             " leaves nothing to register by; give --landmarks FILE."));
  }
}

void check_channels(const RegisterOptions& o) {
  const std::size_t n = o.num_channels();
  if (o.moving.size() != n) {
    throw UsageError(message("--fixed is given ", times(n), ", but --moving ",
                             times(o.moving.size()), "; each channel needs both."));
  }
  if (o.metric.size() != 1 && o.metric.size() != n) {
    throw UsageError(message("--metric is given ", times(o.metric.size()), " for ", n,
                             n == 1 ? " channel" : " channels",
                             "; give one for all channels, or one for each."));
  }
  if (o.metric.size() > 1 && std::ranges::count(o.metric, "none") > 0) {
    throw UsageError("--metric none is for landmarks alone; leave the channel out instead.");
  }
  const auto& weights = o.channel_weights;
  if (weights.empty()) return;
  if (weights.size() != n) {
    throw UsageError(message("--channel-weights has ", weights.size(), " for ", n,
                             n == 1 ? " channel" : " channels", "; give one for each."));
  }
  if (n == 1) {
    throw UsageError(
        "--channel-weights weighs several channels against each other; with one, take --alpha.");
  }
  if (std::ranges::max(weights) == 0) {
    throw UsageError("--channel-weights are all zero; give at least one above 0.");
  }
}

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
  std::vector<Option> all = input_options(options);
  for (auto part : {domain_options(options), cost_options(options), options_of(options.material),
                    solver_options(options), options_of(options.run)}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

void check(const RegisterOptions& options) {
  check_channels(options);
  check_transform(options);
  check_energy(options);
  check_adaptation(options);
  check_landmarks(options);
  check_weights(options);
}

}  // namespace crease

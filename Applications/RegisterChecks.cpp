// Which options of `crease register` exclude or need each other.
#include <algorithm>

#include "Applications/ExitCode.h"
#include "Applications/RegisterOptions.h"

namespace crease {
namespace {

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
  if (!o.has_elastic_energy()) {
    if (!o.material.any_given()) return;
    throw UsageError(
        "--young, --poisson, --material and --plane describe elastic tissue; add --energy "
        "elastic.");
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
  if (o.has_elastic_energy()) {
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
  if (bending && !o.has_elastic_energy() && o.spline_degree() == 1) {
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

}  // namespace

void check(const RegisterOptions& options) {
  check_channels(options);
  check_transform(options);
  check_energy(options);
  check_adaptation(options);
  check_landmarks(options);
  check_weights(options);
}

}  // namespace crease

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "Applications/MaterialOptions.h"
#include "Applications/Option.h"
#include "Applications/RunOptions.h"
#include "Registration/Mammogram/ContourPairs.h"

namespace crease {

/// The options of `crease elastic`, as they were typed.
struct ElasticCommandOptions {
  RunOptions run;
  std::string fixed, moving, output;
  std::vector<double> spacing;
  std::vector<std::string> pairs;
  std::optional<int> contour_pairs, pectoral_pairs;
  std::string roi = "auto";
  std::optional<std::string> regions;
  std::optional<std::string> pectoral;
  std::string mirror = "auto";
  std::optional<double> threshold;
  bool force = false;
  MaterialOptions material;
  int degree = 2;
  std::optional<int> triangles;
  std::optional<double> mesh_size;
  bool no_creases = false;
  std::string steps = "20";
  std::string corrector = "newton";
  std::string quadrature = "cells";
  bool no_refine = false;
  std::string metric = "ssd";
  std::string refinement = "gauss-newton";
  double damped_step = 0.01;
  std::optional<double> alpha;
  std::optional<double> alpha_relative;
  std::string pin = "corners";
  int levels = 4;
  std::vector<double> smoothing = {3, 1.5, 0.75};
  std::optional<std::string> truth;

  bool roi_is_file() const { return roi != "auto" && roi != "image"; }
  /// Where the pectoral line comes from: "auto", "none" or a file.
  std::string pectoral_source() const { return pectoral.value_or(roi == "auto" ? "auto" : "none"); }
  bool pectoral_is_file() const {
    return pectoral_source() != "auto" && pectoral_source() != "none";
  }
  /// Pairs along the skin line, found in the images.
  int num_contour_pairs() const {
    return contour_pairs.value_or(pairs.empty() ? ContourPairOptions{}.count : 0);
  }
  /// Pairs along the edge of the pectoral muscle, where it is found in both.
  int num_pectoral_pairs() const {
    return pectoral_pairs.value_or(num_contour_pairs() > 0 && pectoral_source() != "none" ? 4 : 0);
  }
  /// Whether the images are looked at as mammograms.
  bool needs_anatomy() const {
    return roi == "auto" || pectoral_source() != "none" || num_contour_pairs() > 0;
  }
  /// How many equal steps. Not with --steps adaptive.
  int num_steps() const { return std::stoi(steps); }
};

/// The options that set these.
std::vector<Option> options_of(ElasticCommandOptions& options);

/// What single options cannot tell: which ones exclude or need each other.
/// @throws UsageError naming the options.
void check(const ElasticCommandOptions& options);

}  // namespace crease

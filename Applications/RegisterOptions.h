#pragma once

#include <optional>
#include <string>
#include <vector>

#include "Applications/MaterialOptions.h"
#include "Applications/Option.h"
#include "Applications/RunOptions.h"

namespace crease {

/// The options of `crease register`, as they were typed.
struct RegisterOptions {
  RunOptions run;
  std::vector<std::string> fixed, moving;  ///< of each channel
  std::string output;
  std::string transform = "triangular-bspline";
  std::optional<int> degree, smoothness;
  std::optional<double> mesh_size;
  std::optional<int> triangles;
  std::optional<std::string> roi;
  bool no_creases = false;
  std::optional<std::string> feature_lines, rigid_labels;
  std::vector<std::string> landmarks;
  std::string landmarks_mode = "exact";
  std::optional<double> landmarks_sigma;
  std::string landmarks_conflict = "error";
  std::vector<std::string> metric = {"ssd"};  ///< of all channels, or of each
  std::vector<double> channel_weights;        ///< empty: 1 each
  std::string energy = "bending";
  MaterialOptions material;  ///< of an elastic energy
  std::optional<std::string> fixed_mask, moving_mask;
  std::string interpolator = "cubic";
  double alpha = 1;
  std::optional<double> beta, gamma;
  std::string optimizer = "gauss-newton";
  std::string null_space = "elimination";
  int levels = 3;
  int adapt = 0;
  double sample_fraction = 1;
  std::optional<std::string> init;
  std::optional<std::string> init_transform;
  std::vector<double> spacing;
  bool require_invertible = false;

  bool is_triangular() const { return transform == "triangular-bspline"; }
  bool has_triangles() const { return is_triangular() || transform == "powell-sabin"; }
  bool is_linear() const {
    return transform == "rigid" || transform == "similarity" || transform == "affine";
  }
  /// Whether its motions are splines on a basis.
  bool has_basis() const { return !is_linear() && transform != "cauchy-navier"; }
  /// Whether there is none but in the plane.
  bool is_plane_only() const { return has_triangles() || transform == "tspline"; }
  /// Whether its patches can be divided where the images ask for it.
  bool can_adapt() const { return has_triangles() || transform == "tspline"; }
  std::size_t num_channels() const { return fixed.size(); }
  const std::string& metric_of(std::size_t channel) const {
    return metric[metric.size() == 1 ? 0 : channel];
  }
  double weight_of(std::size_t channel) const {
    return channel_weights.empty() ? 1 : channel_weights[channel];
  }
  std::string metric_name() const;  ///< of the sum over channels, as MetricSum::name()
  bool has_metric() const { return metric.front() != "none"; }
  bool expects_equal_intensities() const { return metric.front() == "ssd" || !has_metric(); }
  int spline_degree() const { return transform == "powell-sabin" ? 2 : degree.value_or(3); }
  int spline_smoothness() const { return smoothness.value_or(spline_degree() - 1); }
  /// Weights as they hold: alpha of the metric, beta of rigidity, 0 where a term is absent.
  double image_weight() const { return has_metric() ? alpha : 0; }
  double rigidity_weight() const { return beta.value_or(1); }
  /// Whether bodies may be known, from labels or closed lines.
  bool may_have_bodies() const { return rigid_labels || feature_lines; }
  /// Whether the motion is that of an elastic body, rather than one that resists bending.
  bool has_elastic_energy() const { return energy == "elastic"; }
  bool init_is_file() const;
};

/// The options that set these.
std::vector<Option> options_of(RegisterOptions& options);

/// What single options cannot tell: which ones exclude or need each other.
/// @throws UsageError naming the options.
void check(const RegisterOptions& options);

}  // namespace crease

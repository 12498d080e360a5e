#pragma once

#include <optional>
#include <string>
#include <vector>

#include "Applications/Option.h"
#include "Transforms/Energies/ElasticMaterial.h"

namespace crease {

/// What elastic tissue is made of, as it was typed.
struct MaterialOptions {
  std::vector<std::string> young, poisson;  ///< "E" of all tissue, "label=E" of one region
  std::optional<std::string> law;           ///< --material; without it "st-venant-kirchhoff"
  std::string plane = "stress";
  bool mean_dilatation = false;

  bool any_given() const;
};

/// `--young`, `--poisson`, `--material` and `--plane`.
std::vector<Option> options_of(MaterialOptions& options);
/// `--mean-dilatation`, of load steps: it couples all control points of a patch, which a registration's matrix
/// has no room for.
Option mean_dilatation_option(MaterialOptions& options);

/// As --material names it.
std::string law_name(ElasticLaw law);

/// @throws UsageError naming the option and what cannot be read, or lies out of range.
ElasticMaterial material_of(const MaterialOptions& options);

}  // namespace crease

#include "Applications/MaterialOptions.h"

#include <charconv>
#include <functional>
#include <sstream>

#include "Applications/ExitCode.h"

namespace crease {
namespace {

template <typename Number>
Number parse(const std::string& option, const std::string& text) {
  Number value{};
  const auto [last, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && last == text.data() + text.size() && !text.empty()) return value;
  throw UsageError(message("--", option, ": \"", text, "\" is not a ",
                           std::is_integral_v<Number> ? "region's label" : "number",
                           "; write E for all tissue, or LABEL=E for one region."));
}

/// Calls set(tissue, value) for "value" and "label=value", separated by commas.
void read_list(const std::string& option, const std::vector<std::string>& given,
               ElasticMaterial& material, const std::function<void(ElasticTissue&, double)>& set) {
  for (const std::string& typed : given) {
    std::istringstream parts(typed);
    for (std::string part; std::getline(parts, part, ',');) {
      const auto equals = part.find('=');
      if (equals == std::string::npos) {
        set(material.tissue, parse<double>(option, part));
        continue;
      }
      const int label = parse<int>(option, part.substr(0, equals));
      // What is not said of a region is as in the other tissue.
      ElasticTissue& tissue = material.regions.try_emplace(label, material.tissue).first->second;
      set(tissue, parse<double>(option, part.substr(equals + 1)));
    }
  }
}

constexpr const char* kNeoHookean = "neo-hookean";
constexpr const char* kStVenantKirchhoff = "st-venant-kirchhoff";

}  // namespace

std::string law_name(ElasticLaw law) {
  return law == ElasticLaw::kNeoHookean ? kNeoHookean : kStVenantKirchhoff;
}

bool MaterialOptions::any_given() const {
  const MaterialOptions none;
  return !young.empty() || !poisson.empty() || law || plane != none.plane;
}

std::vector<Option> options_of(MaterialOptions& o) {
  return {
      {.name = "young",
       .target = &o.young,
       .placeholder = "E[,LABEL=E]",
       .help = "Young's modulus of tissue, and of the regions of labels; only ratios matter (1)"},
      {.name = "poisson",
       .target = &o.poisson,
       .placeholder = "NU[,LABEL=NU]",
       .help = "Poisson's ratio likewise, above -1 and below 0.5 (0.495)"},
      {.name = "material",
       .target = &o.law,
       .help = "Law of elasticity (st-venant-kirchhoff); neo-hookean tissue does not fold",
       .choices = {kStVenantKirchhoff, kNeoHookean}},
      {.name = "plane",
       .target = &o.plane,
       .help = "In 2D: tissue grows thicker and thinner freely (stress), or is held (strain)",
       .choices = {"stress", "strain"}},
  };
}

Option mean_dilatation_option(MaterialOptions& o) {
  return {.name = "mean-dilatation",
          .target = &o.mean_dilatation,
          .help = "Take changes of area by their mean over each patch, against locking"};
}

ElasticMaterial material_of(const MaterialOptions& options) {
  ElasticMaterial material;
  if (options.law == kNeoHookean) material.law = ElasticLaw::kNeoHookean;
  if (options.plane == "strain") material.plane = PlaneState::kStrain;
  material.mean_dilatation = options.mean_dilatation;
  // All tissue first, so that regions inherit what holds for it whatever the order.
  ElasticMaterial common = material;
  const auto set_young = [](ElasticTissue& tissue, double value) { tissue.young = value; };
  const auto set_poisson = [](ElasticTissue& tissue, double value) { tissue.poisson = value; };
  read_list("young", options.young, common, set_young);
  read_list("poisson", options.poisson, common, set_poisson);
  material.tissue = common.tissue;
  read_list("young", options.young, material, set_young);
  read_list("poisson", options.poisson, material, set_poisson);
  try {
    check_material(material);
  } catch (const InvalidInput& error) {
    throw UsageError(message("--young, --poisson: ", error.what()));
  }
  return material;
}

}  // namespace crease

#pragma once

#include <string>

#include "Registration/MetricFactories.h"

namespace crease {

/// The metric that `--metric` names: ssd, ncc, lncc, mi or nmi.
template <int Dim>
MetricFactory<Dim> metric_named(const std::string& name) {
  if (name == "mi") return mutual_information<Dim>();
  if (name == "nmi") return mutual_information<Dim>({.kind = InformationKind::kNormalized});
  if (name == "lncc") return local_ncc<Dim>();
  return name == "ncc" ? ncc<Dim>() : ssd<Dim>();
}

}  // namespace crease

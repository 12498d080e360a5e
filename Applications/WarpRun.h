#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "Applications/RunOptions.h"
#include "Applications/RunReport.h"
#include "Registration/InverseTransform.h"

namespace crease {

/// What `crease warp` was asked for.
struct WarpCommand {
  RunOptions run;
  std::vector<std::string> transforms;
  std::optional<std::string> moving, reference, output_image, points, output_points, mesh,
      output_mesh, displacement;
  std::string interpolator = "cubic";
  std::optional<double> outside;
  bool inverse = false;
  std::vector<double> spacing;
};

/// What a run has written, for the report.
struct WarpResult {  // NOLINT(bugprone-exception-escape): JSON's move does not throw
  nlohmann::ordered_json figures;
  std::string summary;
  std::optional<InverseResidual> residual;  ///< with --inverse

  std::int64_t unresolved() const { return residual ? residual->unresolved : 0; }
};

/// Reads, maps and writes everything that was asked for.
template <int Dim>
WarpResult warp(const WarpCommand& command, RunReport& report);

}  // namespace crease

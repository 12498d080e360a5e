#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "Applications/RegisterInput.h"
#include "Applications/RegisterOptions.h"
#include "Applications/RunReport.h"
#include "Registration/CreasedDomain.h"
#include "Registration/FinerPlaces.h"

namespace crease {

/// The basis of a registration by splines.
template <int Dim>
struct RegisterBasis {
  std::shared_ptr<const SplineBasis<Dim>> basis;
  std::optional<CreasedDomain> domain;  ///< of splines on triangles
  WeightField<Dim> bodies;              ///< null: no rigid bodies
  /// Labels of points, for bases whose patches have none; null: none, or those of the patches.
  std::function<int(const Point<Dim>&)> region_at;
};

/// Makes the basis that `--transform` and the options of the domain describe; warnings go to the report.
/// @param finer  places that ask for finer patches, with transforms that can_adapt().
/// @throws InvalidInput for lines, labels and landmarks that allow none.
template <int Dim>
RegisterBasis<Dim> make_register_basis(const RegisterOptions& options,
                                       const RegisterInput<Dim>& input, RunReport& report,
                                       const std::vector<FinerPlace<Dim>>& finer = {});

}  // namespace crease

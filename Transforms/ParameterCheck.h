#pragma once

#include <Eigen/Core>
#include <string_view>

#include "Core/Error.h"

namespace crease {

/// What every Transform::set_parameters promises.
/// @throws InvalidInput when the size is wrong or an entry is not finite.
inline void check_parameters(std::string_view transform,
                             const Eigen::Ref<const Eigen::VectorXd>& parameters,
                             Eigen::Index expected) {
  if (parameters.size() != expected) {
    throw InvalidInput(
        message(transform, ": ", parameters.size(), " parameters given, ", expected, " expected."));
  }
  for (Eigen::Index k = 0; k < expected; ++k) {
    if (!std::isfinite(parameters[k])) {
      throw InvalidInput(
          message(transform, ": parameter ", k, " is ", parameters[k], "; all must be finite."));
    }
  }
}

/// What every Transform::add_adjoint asks of its arguments.
inline void check_adjoint(std::string_view transform, std::size_t num_points,
                          std::size_t num_forces, Eigen::Index gradient_size,
                          Eigen::Index num_parameters) {
  if (num_points != num_forces || gradient_size != num_parameters) {
    throw InvalidInput(message(transform, ": the adjoint of ", num_points, " points got ",
                               num_forces, " forces and a gradient of ", gradient_size,
                               " entries instead of ", num_parameters, "."));
  }
}

}  // namespace crease

#pragma once

#include <exception>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "Registration/Phantoms/Phantom.h"
#include "Registration/Registration.h"

namespace crease::experiments {

using Json = nlohmann::ordered_json;

/// How far a map is from the true motion of a body, over the body's pixels.
struct BodyError {
  double rms_mm = 0;           ///< of T - truth
  double rms_gradient = 0;     ///< Frobenius norm of grad T - R
  double angle_error_deg = 0;  ///< of the best rigid fit
  double shift_error_mm = 0;   ///< of the best rigid fit, at the body's centre
};
BodyError body_error(const Transform<2>& transform, const Phantom& phantom,
                     const PhantomBody& body);

/// Range of det grad T over the pixels.
struct JacobianRange {
  double min = 0, max = 0;
};
JacobianRange jacobian_range(const Transform<2>& transform, const Raster<2>& raster);

/// The phantom's square domain in a structured union-jack triangulation whose edges run along the
/// bodies' outlines.
std::shared_ptr<const SplineBasis<2>> structured_basis(const Phantom& phantom, int cells,
                                                       bool creases);

/// One figure that an experiment promises.
struct Threshold {
  std::string what;
  double value = 0;
  double bound = 0;
  bool at_least = false;  ///< value >= bound instead of value <= bound
};

/// Prints the JSON line and the thresholds that are missed (on stderr). Returns the exit code.
int finish(const Json& figures, const std::vector<Threshold>& thresholds);

/// Says what went wrong (on stderr). Returns the exit code.
int give_up(const std::exception& error);

/// The output folder of the command line (created), or the default beside the program.
std::filesystem::path output_folder(int argc, char** argv, const std::string& fallback);

}  // namespace crease::experiments

#pragma once

#include "Core/Error.h"

namespace crease {

/// What the command returns to the shell. Codes of libraries and of the argument parser never leak out.
enum class ExitCode {
  kSuccess = 0,
  kGateFailed = 1,      ///< finished and written, but a quality gate asked for was not met
  kUsage = 2,           ///< wrong options or configuration
  kBadData = 3,         ///< an input file or what it holds
  kOutOfResources = 4,  ///< memory or time
  kNotConverged = 5,    ///< no solution; the last good state is written when there is one
  kInternalError = 70
};

/// The command line or configuration is wrong: kUsage.
class UsageError : public Error {
 public:
  using Error::Error;
};

}  // namespace crease

#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace crease {

/// What every exception of crease derives from. `what()` says what was wrong, where, and what to do.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The caller can mend it: arguments, options, data that contradict each other.
class InvalidInput : public Error {
 public:
  using Error::Error;
};

/// A file that is missing, unreadable, truncated or cannot be written.
class FileError : public Error {
 public:
  using Error::Error;
};

/// A numerical failure: a singular system, a value that is not a number.
class SolverError : public Error {
 public:
  using Error::Error;
};

/// Streams its parts into one string: `message("row ", 3, ": expected ", 4, " columns")`.
template <typename... Parts>
std::string message(const Parts&... parts) {
  std::ostringstream stream;
  (stream << ... << parts);
  return stream.str();
}

}  // namespace crease

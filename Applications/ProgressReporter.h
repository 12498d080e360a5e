#pragma once

#include <chrono>
#include <iosfwd>
#include <string>

#include "Applications/RunOptions.h"
#include "Registration/Progress.h"

namespace crease {

/// Tells on a stream where a run stands: a bar that is redrawn, one line per stage and level, one JSON
/// object per line, or nothing.
class ProgressReporter {
 public:
  enum class Style { kNothing, kBar, kLines, kJson };

  /// @param command  the subcommand, named in warnings.
  ProgressReporter(const RunOptions& run, std::string command);
  /// For tests and other streams. @param stream  must outlive the reporter.
  ProgressReporter(Style style, std::ostream& stream, std::string command);
  /// Clears the bar.
  ~ProgressReporter();
  ProgressReporter(const ProgressReporter&) = delete;
  ProgressReporter& operator=(const ProgressReporter&) = delete;

  void report(const RegistrationProgress& progress);
  void warn(const std::string& text);
  /// What Registration::run() takes; the reporter must outlive it.
  RegistrationCallback callback();

 private:
  using Clock = std::chrono::steady_clock;
  double elapsed_s() const;
  /// Estimate from the fraction done; negative while nothing can be said.
  double remaining_s(const RegistrationProgress& progress) const;
  void draw_bar(const RegistrationProgress& progress);
  void print_line(const RegistrationProgress& progress);
  void print_json(const RegistrationProgress& progress);
  void clear_bar();

  Style style_;
  std::ostream& stream_;
  std::string command_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_print_{};
  std::string last_stage_;
  int last_level_ = 0;
  double fraction_ = 0;  // never falls, though stages begin anew
  bool bar_drawn_ = false;
};

}  // namespace crease

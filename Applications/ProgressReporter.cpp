#include "Applications/ProgressReporter.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>

namespace crease {
namespace {

ProgressReporter::Style style_of(const RunOptions& run) {
  using Style = ProgressReporter::Style;
  if (run.quiet) return Style::kNothing;
  if (run.progress == "json") return Style::kJson;
  if (run.progress == "bar") return Style::kBar;
  if (run.progress == "lines") return Style::kLines;
  return isatty(STDERR_FILENO) != 0 ? Style::kBar : Style::kLines;
}

std::string time_text(double seconds) {
  if (seconds < 0) return "";
  if (seconds < 60) return fmt::format("{:.0f} s left", std::ceil(seconds));
  return fmt::format("{:.0f} min left", std::ceil(seconds / 60));
}

/// "level 2/3, iteration 4, energy 1.25e+03".
std::string state_text(const RegistrationProgress& progress) {
  std::string text = progress.stage;
  if (progress.stage == "level") text += fmt::format(" {}/{}", progress.level, progress.num_levels);
  if (progress.iteration > 0) {
    text += fmt::format(", iteration {}, energy {:.4g}", progress.iteration, progress.energy);
  }
  return text;
}

}  // namespace

ProgressReporter::ProgressReporter(const RunOptions& run, std::string command)
    : ProgressReporter(style_of(run), std::cerr, std::move(command)) {}

ProgressReporter::ProgressReporter(Style style, std::ostream& stream, std::string command)
    : style_(style), stream_(stream), command_(std::move(command)) {}

ProgressReporter::~ProgressReporter() { clear_bar(); }

void ProgressReporter::report(const RegistrationProgress& told) {
  RegistrationProgress progress = told;
  progress.fraction = fraction_ = std::clamp(told.fraction, fraction_, 1.0);
  if (style_ == Style::kJson) print_json(progress);
  if (style_ == Style::kLines) print_line(progress);
  if (style_ == Style::kBar) draw_bar(progress);
  last_stage_ = progress.stage;
  last_level_ = progress.level;
}

void ProgressReporter::warn(const std::string& text) {
  if (style_ == Style::kNothing) return;
  clear_bar();
  if (style_ == Style::kJson) {
    stream_ << nlohmann::json{{"warning", text}}.dump() << std::endl;
  } else {
    stream_ << "crease " << command_ << ": warning: " << text << std::endl;
  }
}

RegistrationCallback ProgressReporter::callback() {
  return [this](const RegistrationProgress& progress) {
    report(progress);
    return true;
  };
}

double ProgressReporter::elapsed_s() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

double ProgressReporter::remaining_s(const RegistrationProgress& progress) const {
  constexpr double kEnough = 0.02;  // below this share the estimate would jump about
  if (progress.fraction < kEnough) return -1;
  return elapsed_s() * (1 - progress.fraction) / progress.fraction;
}

void ProgressReporter::draw_bar(const RegistrationProgress& progress) {
  constexpr int kWidth = 24;
  constexpr int kLineWidth = 100;
  constexpr auto kInterval = std::chrono::milliseconds(50);
  const bool news = progress.stage != last_stage_ || progress.level != last_level_;
  if (!news && Clock::now() - last_print_ < kInterval) return;
  last_print_ = Clock::now();
  const double fraction = progress.fraction;
  const int filled = static_cast<int>(fraction * kWidth);
  const std::string line =
      fmt::format("[{:#<{}}{:.<{}}] {:3.0f} %  {}  {}", "", filled, "", kWidth - filled,
                  100 * fraction, state_text(progress), time_text(remaining_s(progress)));
  stream_ << fmt::format("\r{:<{}.{}}", line, kLineWidth, kLineWidth) << std::flush;
  bar_drawn_ = true;
}

void ProgressReporter::print_line(const RegistrationProgress& progress) {
  constexpr auto kInterval = std::chrono::seconds(5);
  const bool news = progress.stage != last_stage_ || progress.level != last_level_;
  if (!news && Clock::now() - last_print_ < kInterval) return;
  last_print_ = Clock::now();
  stream_ << fmt::format("{:6.2f} s  {:3.0f} %  {}", elapsed_s(), 100 * progress.fraction,
                         state_text(progress))
          << std::endl;
}

void ProgressReporter::print_json(const RegistrationProgress& progress) {
  nlohmann::ordered_json line = {
      {"stage", progress.stage},       {"level", progress.level},
      {"levels", progress.num_levels}, {"iteration", progress.iteration},
      {"energy", progress.energy},     {"fraction", progress.fraction},
      {"elapsed_s", elapsed_s()},
  };
  if (const double left = remaining_s(progress); left >= 0) line["remaining_s"] = left;
  stream_ << line.dump() << std::endl;
}

void ProgressReporter::clear_bar() {
  if (bar_drawn_) stream_ << "\r\033[K" << std::flush;
  bar_drawn_ = false;
}

}  // namespace crease

#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "Testing/TemporaryFolder.h"

namespace crease::testing {

/// A headless Chromium with one page, driven by the DevTools protocol over a pipe: no display, no network,
/// a profile of its own that goes with it. Every call answers within a minute or throws.
class Browser {
 public:
  /// The browser's program, empty where none is installed.
  static std::string program();

  Browser();
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Shows a file in a window of this size. @param scheme  "light" or "dark": what the system prefers.
  void open(const std::filesystem::path& file, int width, int height,
            const std::string& scheme = "light");
  void prefer(const std::string& scheme);
  /// The value of a JavaScript expression, of what it promises if it is a promise.
  /// @throws std::runtime_error with the exception's text.
  nlohmann::json evaluate(const std::string& expression);
  /// Waits until an expression is true. @return false when it does not come true.
  bool becomes_true(const std::string& expression);
  /// Presses a key as a user does: "ArrowLeft", "PageDown", " ", "2", ...
  void press(const std::string& key);
  /// Presses the mouse's button at a point of the window, moves to another and lets go.
  void drag(double from_x, double from_y, double to_x, double to_y);
  /// Saves what the window shows as PNG.
  void save_picture(const std::filesystem::path& file);
  /// Uncaught exceptions, errors and warnings on the console, requests that left the page.
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  nlohmann::json call(const std::string& method, const nlohmann::json& parameters = {});
  nlohmann::json read_message();
  void note(const nlohmann::json& event);

  TemporaryFolder profile_;
  pid_t process_ = 0;
  int to_browser_ = -1, from_browser_ = -1;
  int last_call_ = 0;
  std::string session_, unread_;
  std::vector<std::string> problems_;
};

}  // namespace crease::testing

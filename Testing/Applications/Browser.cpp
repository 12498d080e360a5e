#include "Testing/Applications/Browser.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <map>
#include <sstream>
#include <stdexcept>
#include <thread>

extern char** environ;

namespace crease::testing {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = std::chrono::seconds(60);  // on a machine with much else to do
constexpr int kBrowserReads = 3, kBrowserWrites = 4;  // file descriptors, as Chromium expects them

/// A pipe whose ends are out of the way of the browser's descriptors.
std::array<int, 2> make_pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe for the browser");
  for (int& end : ends) {
    constexpr int kLowest = 10;
    const int moved = fcntl(end, F_DUPFD_CLOEXEC, kLowest);
    close(end);
    end = moved;
  }
  return ends;
}

/// In a process group of its own, so that all its helpers can be ended with it.
pid_t start(std::vector<std::string> command, int reads, int writes) {
  std::vector<char*> argv;
  for (std::string& text : command) argv.push_back(text.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, reads, kBrowserReads);
  posix_spawn_file_actions_adddup2(&actions, writes, kBrowserWrites);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t process = 0;
  const int error =
      posix_spawn(&process, argv.front(), &actions, &attributes, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw std::runtime_error("the browser cannot be started");
  return process;
}

int key_code(const std::string& key) {
  static const std::map<std::string, int> kCodes = {
      {"Tab", 9},       {"End", 35},       {"Home", 36},       {"PageUp", 33},
      {"PageDown", 34}, {"ArrowLeft", 37}, {"ArrowRight", 39}, {"Enter", 13}};
  const auto known = kCodes.find(key);
  return known != kCodes.end() ? known->second : static_cast<int>(key.front());
}

std::string bytes_of_base64(const std::string& text) {
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    static const std::string kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const auto digit = kDigits.find(c);
    if (digit == std::string::npos) break;
    bits = bits << 6 | static_cast<unsigned>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255);
  }
  return bytes;
}

}  // namespace

std::string Browser::program() {
  const char* const path = std::getenv("PATH");
  for (const char* name : {"chromium", "chromium-headless-shell", "google-chrome"}) {
    std::istringstream folders(path != nullptr ? path : "/usr/bin");
    for (std::string folder; std::getline(folders, folder, ':');) {
      std::string file = folder + "/" + name;
      if (access(file.c_str(), X_OK) == 0) return file;
    }
  }
  return "";
}

Browser::Browser() {
  const auto commands = make_pipe(), answers = make_pipe();
  to_browser_ = commands[1];
  from_browser_ = answers[0];
  // Root in a container has no sandbox, and often little shared memory.
  process_ =
      start({program(), "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
             "--disable-extensions", "--no-first-run", "--disable-background-networking",
             "--hide-scrollbars", "--remote-debugging-pipe",
             "--user-data-dir=" + profile_.path().string(), "about:blank"},
            commands[0], answers[1]);
  close(commands[0]);
  close(answers[1]);
  const Json target = call("Target.createTarget", {{"url", "about:blank"}});
  session_ = call("Target.attachToTarget", {{"targetId", target.at("targetId")}, {"flatten", true}})
                 .at("sessionId");
  for (const char* domain : {"Page", "Runtime", "Log", "Network"}) {
    call(std::string(domain) + ".enable");
  }
}

Browser::~Browser() {
  kill(-process_, SIGKILL);
  int status = 0;
  waitpid(process_, &status, 0);
  close(to_browser_);
  close(from_browser_);
}

void Browser::open(const std::filesystem::path& file, int width, int height,
                   const std::string& scheme) {
  call("Emulation.setDeviceMetricsOverride",
       {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
  prefer(scheme);
  call("Page.navigate", {{"url", "about:blank"}});
  call("Page.navigate", {{"url", "file://" + file.string()}});
  if (!becomes_true("location.href !== 'about:blank' && document.readyState === 'complete'")) {
    throw std::runtime_error("the browser does not show " + file.string());
  }
}

void Browser::prefer(const std::string& scheme) {
  call("Emulation.setEmulatedMedia",
       {{"features", {{{"name", "prefers-color-scheme"}, {"value", scheme}}}}});
}

Json Browser::evaluate(const std::string& expression) {
  const Json answer =
      call("Runtime.evaluate",
           {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}});
  if (answer.contains("exceptionDetails")) {
    throw std::runtime_error(expression + ": " + answer.at("exceptionDetails").dump());
  }
  return answer.at("result").value("value", Json());
}

bool Browser::becomes_true(const std::string& expression) {
  const auto start = Clock::now();
  while (Clock::now() - start < kPatience) {
    if (evaluate("Boolean(" + expression + ")") == true) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

void Browser::press(const std::string& key) {
  Json event = {{"type", "keyDown"}, {"key", key}, {"windowsVirtualKeyCode", key_code(key)}};
  if (key.size() == 1) event["text"] = key;
  call("Input.dispatchKeyEvent", event);
  event["type"] = "keyUp";
  event.erase("text");
  call("Input.dispatchKeyEvent", event);
}

void Browser::drag(double from_x, double from_y, double to_x, double to_y) {
  const auto send = [&](const char* type, double x, double y, int buttons) {
    call("Input.dispatchMouseEvent", {{"type", type},
                                      {"x", x},
                                      {"y", y},
                                      {"button", "left"},
                                      {"buttons", buttons},
                                      {"clickCount", 1}});
  };
  send("mousePressed", from_x, from_y, 1);
  send("mouseMoved", 0.5 * (from_x + to_x), 0.5 * (from_y + to_y), 1);
  send("mouseMoved", to_x, to_y, 1);
  send("mouseReleased", to_x, to_y, 0);
}

void Browser::save_picture(const std::filesystem::path& file) {
  const Json picture = call("Page.captureScreenshot", {{"format", "png"}});
  std::ofstream(file, std::ios::binary) << bytes_of_base64(picture.at("data"));
}

Json Browser::call(const std::string& method, const Json& parameters) {
  Json command = {{"id", ++last_call_}, {"method", method}};
  command["params"] = parameters.is_null() ? Json::object() : parameters;
  if (!session_.empty()) command["sessionId"] = session_;
  const std::string text = command.dump() + '\0';
  for (std::size_t sent = 0; sent < text.size();) {
    const auto count = write(to_browser_, text.data() + sent, text.size() - sent);
    if (count <= 0) throw std::runtime_error("the browser does not listen");
    sent += static_cast<std::size_t>(count);
  }
  while (true) {
    const Json answer = read_message();
    if (answer.value("id", 0) != last_call_) {
      note(answer);
    } else if (answer.contains("error")) {
      throw std::runtime_error(method + ": " + answer.at("error").dump());
    } else {
      return answer.at("result");
    }
  }
}

Json Browser::read_message() {
  const auto start = Clock::now();
  std::size_t end = 0;
  while ((end = unread_.find('\0')) == std::string::npos) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(kPatience - (Clock::now() - start));
    pollfd waiting{from_browser_, POLLIN, 0};
    if (left.count() <= 0 || poll(&waiting, 1, static_cast<int>(left.count())) <= 0) {
      throw std::runtime_error("the browser does not answer");
    }
    std::array<char, 65536> buffer{};
    const auto count = read(from_browser_, buffer.data(), buffer.size());
    if (count <= 0) throw std::runtime_error("the browser has gone");
    unread_.append(buffer.data(), static_cast<std::size_t>(count));
  }
  Json message = Json::parse(unread_.substr(0, end));
  unread_.erase(0, end + 1);
  return message;
}

void Browser::note(const Json& event) {
  const std::string method = event.value("method", "");
  const Json parameters = event.value("params", Json::object());
  const bool of_console = method == "Runtime.consoleAPICalled" &&
                          (parameters.at("type") == "error" || parameters.at("type") == "warning");
  const bool of_log = method == "Log.entryAdded" && parameters.at("entry").at("level") == "error";
  if (of_console || of_log || method == "Runtime.exceptionThrown") {
    problems_.push_back(parameters.dump());
  } else if (method == "Network.requestWillBeSent") {
    const std::string url = parameters.at("request").at("url");
    if (!url.starts_with("file:") && !url.starts_with("data:") && url != "about:blank") {
      problems_.push_back("request to " + url);
    }
  }
}

}  // namespace crease::testing

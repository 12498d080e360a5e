#include "Testing/Applications/CommandRunner.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "Testing/TemporaryFolder.h"

extern char** environ;

namespace crease::testing {
namespace {

/// Starts a program with its streams going to files.
pid_t start(const std::string& program, const std::vector<std::string>& arguments,
            const std::string& out, const std::string& err) {
  std::vector<std::string> texts = {program};
  texts.insert(texts.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& text : texts) argv.push_back(text.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), kFlags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), kFlags, 0600);
  pid_t process = 0;
  const int error = posix_spawn(&process, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error(program + " cannot be started");
  return process;
}

int exit_code(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

CommandResult run_program(const std::string& program, const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const std::string out = (folder / "out").string(), err = (folder / "err").string();
  const pid_t process = start(program, arguments, out, err);
  int status = 0;
  waitpid(process, &status, 0);
  return {exit_code(status), read_text(out), read_text(err)};
}

CommandResult run_crease(const std::vector<std::string>& arguments) {
  return run_program(CREASE_COMMAND, arguments);
}

bool kill_crease(const std::vector<std::string>& arguments,
                 const std::function<bool(const std::string& err)>& when) {
  const TemporaryFolder folder;
  const std::string err = (folder / "err").string();
  const pid_t process = start(CREASE_COMMAND, arguments, (folder / "out").string(), err);
  int status = 0;
  while (waitpid(process, &status, WNOHANG) == 0) {
    if (when(read_text(err))) {
      kill(process, SIGKILL);
      waitpid(process, &status, 0);
      return WIFSIGNALED(status);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

nlohmann::json read_result(const std::filesystem::path& folder) {
  return nlohmann::json::parse(read_text(folder / "result.json"));
}

std::string shared_file(const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(CREASE_SHARED_DIR) / "data" / name;
  return std::filesystem::exists(file) ? file.string() : "";
}

}  // namespace crease::testing

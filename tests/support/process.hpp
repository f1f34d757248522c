#pragma once

#include <sys/types.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/becomes_true.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::test {

/// The whole content of a file; empty if there is none.
std::string content(const std::filesystem::path& file);

void write_file(const std::filesystem::path& file, std::string_view text);

/// One running program, its standard output and error kept in files. The program never outlives this object; if the
/// test has failed by then, its output is printed.
class Process {
 public:
  enum class Input { none, pipe };

  /// Starts `program`, a path. Standard input is empty, or written by `write`.
  /// @throws std::system_error if it cannot be started.
  Process(const std::filesystem::path& program, const std::vector<std::string>& arguments, Input input = Input::none);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  [[nodiscard]] pid_t pid() const { return pid_; }

  /// The program's output so far.
  [[nodiscard]] std::string out() const { return content(folder_.file("stdout")); }
  [[nodiscard]] std::string err() const { return content(folder_.file("stderr")); }

  /// Waits for the end: the exit code, 128 + number for a program ended by a signal, nothing if it still runs.
  std::optional<int> wait(std::chrono::nanoseconds limit = kPatience);

  /// Waits until standard output followed by error contains `text`; false if that does not happen in time, or the
  /// program ends without it.
  bool wait_for(std::string_view text, std::chrono::nanoseconds limit = kPatience);

  void signal(int number) const;

  /// Sends SIGINT or SIGTERM and waits for the end.
  std::optional<int> stop(int number = SIGTERM);

  void write(std::string_view text) const;
  void close_input();

 private:
  bool reap();

  TemporaryFolder folder_;
  std::string command_;
  pid_t pid_ = -1;
  int input_ = -1;
  std::optional<int> exit_code_;
};

}  // namespace forcebound::test

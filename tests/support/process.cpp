#include "tests/support/process.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <system_error>

namespace forcebound::test {
namespace {

[[noreturn]] void fail(int number, const std::string& what) {
  throw std::system_error(number, std::generic_category(), what);
}

/// The file actions of posix_spawn; freed with their owner.
struct FileActions {
  FileActions() { posix_spawn_file_actions_init(&actions); }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;

  void write_to(int descriptor, const std::string& file) {
    posix_spawn_file_actions_addopen(&actions, descriptor, file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  }

  posix_spawn_file_actions_t actions{};
};

}  // namespace

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_file(const std::filesystem::path& file, std::string_view text) {
  std::ofstream(file, std::ios::binary) << text;
}

Process::Process(const std::filesystem::path& program, const std::vector<std::string>& arguments, Input input)
    : command_(program.string()) {
  // A program that ended early must fail an expectation, not end the test by SIGPIPE.
  std::signal(SIGPIPE, SIG_IGN);
  std::array<int, 2> pipe{-1, -1};
  FileActions files;
  if (input == Input::pipe) {
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) fail(errno, "pipe");
    posix_spawn_file_actions_adddup2(&files.actions, pipe[0], STDIN_FILENO);
  } else {
    posix_spawn_file_actions_addopen(&files.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  }
  files.write_to(STDOUT_FILENO, folder_.file("stdout"));
  files.write_to(STDERR_FILENO, folder_.file("stderr"));

  std::vector<std::string> words{command_};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  for (const std::string& argument : arguments) command_.append(" '").append(argument).append("'");
  std::vector<char*> environment;
  for (char** entry = environ; *entry != nullptr; ++entry) environment.push_back(*entry);
  const char* const preloaded = std::getenv("FORCEBOUND_TEST_PRELOAD");
  std::string preload = std::string("LD_PRELOAD=") + (preloaded != nullptr ? preloaded : "");
  if (preloaded != nullptr) environment.push_back(preload.data());
  environment.push_back(nullptr);
  const int error = posix_spawn(&pid_, words.front().c_str(), &files.actions, nullptr, argv.data(), environment.data());
  if (input == Input::pipe) ::close(pipe[0]);
  input_ = pipe[1];
  if (error != 0) fail(error, command_);
}

Process::~Process() {
  close_input();
  if (!reap()) {
    // Also a program that a test has stopped (SIGSTOP).
    signal(SIGKILL);
    static_cast<void>(wait());
  }
  if (!testing::Test::HasFailure()) return;
  std::cerr << "--- " << command_ << "\n--- exit code " << exit_code_.value_or(-1) << ", stdout:\n"
            << out() << "--- stderr:\n"
            << err() << "---\n";
}

bool Process::reap() {
  if (exit_code_) return true;
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return false;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return true;
}

std::optional<int> Process::wait(std::chrono::nanoseconds limit) {
  static_cast<void>(becomes_true([this] { return reap(); }, limit));
  return exit_code_;
}

bool Process::wait_for(std::string_view text, std::chrono::nanoseconds limit) {
  const auto printed = [&] { return (out() + err()).find(text) != std::string::npos; };
  const auto said_or_ended = [&] {
    const bool ended = reap();
    return printed() || ended;
  };
  static_cast<void>(becomes_true(said_or_ended, limit));
  return printed();
}

void Process::signal(int number) const {
  if (!exit_code_) ::kill(pid_, number);
}

std::optional<int> Process::stop(int number) {
  signal(number);
  return wait();
}

void Process::write(std::string_view text) const {
  if (::write(input_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) fail(errno, command_);
}

void Process::close_input() {
  if (input_ >= 0) ::close(input_);
  input_ = -1;
}

}  // namespace forcebound::test

#include "forcebound/client/commands/programs.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

#include "forcebound/text/file.hpp"

namespace forcebound::client::commands {

bool is_program(std::string_view command) noexcept {
  return std::ranges::find(kPrograms, command, &Program::command) != kPrograms.end();
}

void become_program(std::span<char*> arguments) {
  std::string name = std::string("forcebound-") + arguments.front();
  arguments.front() = name.data();
  const std::filesystem::path folder = text::program_path().parent_path();
  if (!folder.empty()) ::execv((folder / name).c_str(), arguments.data());
  if (folder.empty() || errno == ENOENT) ::execvp(name.c_str(), arguments.data());
  throw std::runtime_error(name + ": " + std::generic_category().message(errno) + "; accepted: that program in " +
                           folder.string() + ", where this one is, or on PATH");
}

}  // namespace forcebound::client::commands

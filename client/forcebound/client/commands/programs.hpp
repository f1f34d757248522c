#pragma once

#include <array>
#include <span>
#include <string_view>

/// Forcebound's other programs as commands of `forcebound`, as git does it: `forcebound client ARGS` is
/// `forcebound-client ARGS`.
namespace forcebound::client::commands {

struct Program {
  std::string_view command;  ///< "client" of forcebound-client
  std::string_view about;
};

inline constexpr std::array<Program, 4> kPrograms{{
    {"client", "Run forcebound-client: feel a scene"},
    {"server", "Run forcebound-server: scenes, or a robot"},
    {"relay", "Run forcebound-relay: a bad network, emulated"},
    {"lab", "Run forcebound-lab: studies and experiments"},
}};

/// Whether a command is one of `kPrograms`.
[[nodiscard]] bool is_program(std::string_view command) noexcept;

/// Replaces this process by the program of a command: the one in the folder of this program, else the first on PATH.
/// @param arguments the command and the words after it, as main's argv has them, with the null pointer at the end
/// @throws std::runtime_error with the folders, if there is no such program
[[noreturn]] void become_program(std::span<char*> arguments);

}  // namespace forcebound::client::commands

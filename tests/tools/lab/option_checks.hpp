#pragma once

#include <filesystem>

namespace CLI {
class Validator;
}

/// Checks of options that several commands of the lab have.
namespace forcebound::lab {

/// A law that ships.
CLI::Validator known_law();
/// A device that ships, or a file.
CLI::Validator known_device();
/// A scene that ships, or a file.
CLI::Validator known_scene();
/// none, netem's words, or trace:FILE.
CLI::Validator known_network();
/// FILE.png: a figure's data and script stand beside it, with other extensions.
CLI::Validator png_file();

/// Whether both name one file, there or not yet.
[[nodiscard]] bool is_same_path(const std::filesystem::path& one, const std::filesystem::path& other);

}  // namespace forcebound::lab

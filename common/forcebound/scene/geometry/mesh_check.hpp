#pragma once

#include <string>

namespace forcebound::scene {

/// Looks for the mistakes in a mesh file that an importer may pass over silently or not say the line of: coordinates
/// that are no finite numbers in single precision, indices out of range, faces without three corners, and what ends too
/// early. `path` is for messages; `content` is the whole file.
///
/// @throws std::runtime_error `PATH:LINE: what is wrong`; without the line where the file is not text.
void check_obj(const std::string& path, const std::string& content);
void check_off(const std::string& path, const std::string& content);
void check_stl(const std::string& path, const std::string& content);

}  // namespace forcebound::scene

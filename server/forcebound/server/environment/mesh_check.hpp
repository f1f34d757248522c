#pragma once

#include <string>

namespace forcebound::server {

/// Finds mistakes in a mesh file that the importer passes over silently or reports without the line: coordinates that
/// are not finite in single precision, indices out of range, faces without three corners, files that end too early.
/// `path` is for messages; `content` is the whole file.
///
/// @throws std::runtime_error `PATH:LINE: what is wrong`; without the line where the file is not text.
void check_obj(const std::string& path, const std::string& content);
void check_off(const std::string& path, const std::string& content);
void check_stl(const std::string& path, const std::string& content);

/// An STL file that `check_stl` accepts as every importer reads it: a text in small letters from its first byte on,
/// with `endsolid` in one word and no names; a binary one without what follows its last triangle.
[[nodiscard]] std::string plain_stl(const std::string& content);

}  // namespace forcebound::server

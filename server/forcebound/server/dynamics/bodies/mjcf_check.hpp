#pragma once

#include <string>
#include <string_view>

namespace forcebound::server {

/// Refuses MJCF of which we know that it ends the process within MuJoCo 2.2.2, which uses it unchecked: a mesh whose
/// `face` has a vertex that its `vertex` lacks, builtin textures or height fields of more than 256 MiB together.
/// Included files are checked too. What is wrong with the XML or a file is left to MuJoCo to report.
/// @param folder of the file, from which included files are named
/// @throws BodiesError
void check_mjcf(std::string_view text, const std::string& folder);

}  // namespace forcebound::server

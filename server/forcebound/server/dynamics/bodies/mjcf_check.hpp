#pragma once

#include <string_view>

namespace forcebound::server {

/// Refuses MJCF of which we know that it ends the process within MuJoCo 2.2.2, which uses it unchecked, or takes memory
/// or files of this machine as it likes: a mesh whose `face` has a vertex that its `vertex` lacks; builtin textures or
/// height fields of more than 256 MiB together; larger counts in `size`, `composite`, `numeric` and `user` than any
/// model has; anything that names a file; another format than MJCF. What is wrong with the XML is left to MuJoCo to
/// report.
/// @throws BodiesError
void check_mjcf(std::string_view text);

}  // namespace forcebound::server

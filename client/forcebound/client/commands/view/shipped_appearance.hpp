#pragma once

#include <string>

#include "forcebound/client/commands/view/recorded.hpp"

namespace forcebound::client::commands {

/// The message `scene` of a recording, which has the scene's name alone: the scene that ships under it, or that of a
/// file. Where there is none, or none that the recorded device fits, it says so.
/// @param file of the scene; empty: by the recording's name
/// @throws std::exception with one line if the file is refused
[[nodiscard]] std::string scene_message_of(const Recorded& recorded, const std::string& file);

}  // namespace forcebound::client::commands

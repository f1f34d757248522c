#pragma once

#include <span>
#include <string>
#include <string_view>

namespace forcebound::client {

/// The known name that `wrong` is most likely a misspelling of, or nothing if none is near: for "did you mean" in
/// errors.
[[nodiscard]] std::string nearest_name(std::string_view wrong, std::span<const std::string> known);

/// "'a', 'b' and 'c'" of what is known, and what was probably meant: the second half of an error about `wrong`.
[[nodiscard]] std::string suggestion(std::string_view wrong, std::span<const std::string> known);

}  // namespace forcebound::client

#pragma once

#include <span>
#include <string>
#include <string_view>

namespace forcebound::text {

/// "a, b, c".
[[nodiscard]] std::string join(std::span<const std::string> names);

/// The known name that `wrong` is most likely a misspelling of, or nothing if none is near.
[[nodiscard]] std::string nearest_name(std::string_view wrong, std::span<const std::string> known);

/// Whether `wrong` is `right` but for two letters, or without its unit: "damping" for "damping_N_s_per_m".
[[nodiscard]] bool is_slip_of(std::string_view wrong, std::string_view right);

/// What an error about an unknown name ends with: ", did you mean 'sphere'? (known: box, sphere)", without the
/// question where no name is near; "; there are none" where nothing is known.
[[nodiscard]] std::string suggestion(std::string_view wrong, std::span<const std::string> known);

}  // namespace forcebound::text

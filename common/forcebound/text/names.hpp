#pragma once

#include <span>
#include <string>
#include <string_view>

namespace forcebound::text {

/// "a, b, c".
[[nodiscard]] std::string join(std::span<const std::string> names);

/// The known name that `wrong` is most likely a misspelling of, or nothing if none is similar.
[[nodiscard]] std::string nearest_name(std::string_view wrong, std::span<const std::string> known);

/// Whether `wrong` differs from `right` by two letters at most, or lacks its unit: "damping" for "damping_N_s_per_m".
[[nodiscard]] bool is_slip_of(std::string_view wrong, std::string_view right);

/// The end of an error about an unknown name: ", did you mean 'sphere'? (known: box, sphere)", without the question
/// where no name is similar; "; there are none" where `known` is empty.
[[nodiscard]] std::string suggestion(std::string_view wrong, std::span<const std::string> known);

}  // namespace forcebound::text

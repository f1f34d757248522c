#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace CLI {
class Validator;
}

/// Checks of an option's value. The message says what would be accepted; --help does not show them.
namespace forcebound::program {

/// One of some names; an unknown one gets a suggestion: "unknown law 'fba', did you mean ...". @param what "law"
CLI::Validator one_of(const std::string& what, std::vector<std::string> names);
/// Any finite number.
CLI::Validator number();
/// A number from `least` to `most`, both included.
CLI::Validator number_within(double least, double most = 1e9);
/// Above 0, and at most 1e9.
CLI::Validator number_above_zero();
CLI::Validator whole_within(std::uint64_t least, std::uint64_t most = std::numeric_limits<std::uint64_t>::max());
/// Not an empty text, as of a shell's variable that is not set.
CLI::Validator not_empty();
/// What a parser accepts, which otherwise throws std::invalid_argument.
CLI::Validator accepted_by(std::function<void(const std::string&)> parser);
/// Likewise; what the parser returns becomes the value. For CLI::Option::transform.
CLI::Validator replaced_by(std::function<std::string(const std::string&)> parser);

}  // namespace forcebound::program

#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "forcebound/text/numbers.hpp"

namespace forcebound::lab {

/// For options that take a number > 0, up to 1e9; the library's own check prints its bound with three hundred digits.
inline CLI::Validator above_zero() {
  return {[](const std::string& value) {
            constexpr double kMost = 1e9;
            const auto number = text::finite_number(value);
            return number && *number > 0 && *number <= kMost
                       ? std::string()
                       : "expected a number above 0, up to 1e9, got '" + value + "'";
          },
          ""};
}

}  // namespace forcebound::lab

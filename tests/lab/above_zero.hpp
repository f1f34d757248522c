#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <string>

namespace forcebound::lab {

/// For options that take a number > 0, up to 1e9; the library's own says so in three hundred digits.
inline CLI::Validator above_zero() {
  return {[](std::string& text) {
            constexpr double kMost = 1e9;
            double value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            const bool number = error == std::errc{} && end == text.data() + text.size();
            return number && value > 0 && value <= kMost ? std::string()
                                                         : "expected a number above 0, up to 1e9, got '" + text + "'";
          },
          ""};
}

}  // namespace forcebound::lab

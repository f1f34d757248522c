#include "forcebound/program/option_checks.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::program {

CLI::Validator one_of(const std::string& what, std::vector<std::string> names) {
  return {[what, names = std::move(names)](const std::string& value) -> std::string {
            if (std::ranges::find(names, value) != names.end()) return {};
            return "unknown " + what + " '" + value + "'" + text::suggestion(value, names);
          },
          ""};
}

CLI::Validator number() {
  return {[](const std::string& value) -> std::string {
            if (text::finite_number(value)) return {};
            return "must be a number such as 0.25 or -1e-3, got '" + value + "'";
          },
          ""};
}

CLI::Validator number_within(double least, double most) {
  return {[least, most](const std::string& value) -> std::string {
            const auto number = text::finite_number(value);
            if (number && *number >= least && *number <= most) return {};
            return "must be a number from " + text::to_text(least) + " to " + text::to_text(most) + ", got '" + value +
                   "'";
          },
          ""};
}

CLI::Validator number_above_zero() {
  return {[](const std::string& value) -> std::string {
            constexpr double kMost = 1e9;
            const auto number = text::finite_number(value);
            if (number && *number > 0 && *number <= kMost) return {};
            return "must be a number above 0, up to 1e9, got '" + value + "'";
          },
          ""};
}

CLI::Validator whole_within(std::uint64_t least, std::uint64_t most) {
  return {[least, most](const std::string& value) -> std::string {
            const auto number = text::whole_number<std::uint64_t>(value);
            if (number && *number >= least && *number <= most) return {};
            return "must be a whole number from " + std::to_string(least) + " to " + std::to_string(most) + ", got '" +
                   value + "'";
          },
          ""};
}

CLI::Validator not_empty() {
  return {[](const std::string& value) -> std::string { return value.empty() ? "must not be empty" : ""; }, ""};
}

CLI::Validator replaced_by(std::function<std::string(const std::string&)> parser) {
  return {[parser = std::move(parser)](std::string& value) -> std::string {
            try {
              value = parser(value);
              return {};
            } catch (const std::invalid_argument& error) {
              return error.what();
            }
          },
          ""};
}

CLI::Validator accepted_by(std::function<void(const std::string&)> parser) {
  return {[parser = std::move(parser)](const std::string& value) -> std::string {
            try {
              parser(value);
              return {};
            } catch (const std::invalid_argument& error) {
              return error.what();
            }
          },
          ""};
}

}  // namespace forcebound::program

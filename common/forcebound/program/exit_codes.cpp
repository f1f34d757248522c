#include "forcebound/program/exit_codes.hpp"

#include <algorithm>

#include "forcebound/program/command_line.hpp"
#include "forcebound/text/lines.hpp"

namespace forcebound::program {

std::string exit_codes_without(std::initializer_list<int> never) {
  constexpr std::string_view kBefore = "Exit code:";
  static_assert(kExitCodes.starts_with(kBefore) && kExitCodes.ends_with('.'));
  std::string line(kBefore);
  for (const std::string_view code :  // "0 done"
       text::split(kExitCodes.substr(kBefore.size(), kExitCodes.size() - kBefore.size() - 1), ',')) {
    if (std::ranges::find(never, code[0] - '0') != never.end()) continue;
    line.append(line.size() > kBefore.size() ? ", " : " ").append(code);
  }
  return line + ".";
}

}  // namespace forcebound::program

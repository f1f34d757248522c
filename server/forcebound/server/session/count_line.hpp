#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace forcebound::server {

struct Count {
  std::string_view what;
  std::uint64_t value;
};

/// "motions: 20 received, 3 reordered": the first count always, the others if they are not zero.
inline std::string count_line(std::string_view subject, Count always, std::initializer_list<Count> if_any) {
  std::string text = std::string(subject) + ": " + std::to_string(always.value) + " " + std::string(always.what);
  for (const Count& count : if_any) {
    if (count.value > 0) text += ", " + std::to_string(count.value) + " " + std::string(count.what);
  }
  return text + "\n";
}

}  // namespace forcebound::server

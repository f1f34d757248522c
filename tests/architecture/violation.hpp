#pragma once

#include <string>

namespace forcebound::architecture {

struct Violation {
  std::string file;  ///< relative to the source root
  int line = 0;
  std::string what;  ///< the offending text and what would be accepted
};

inline std::string to_string(const Violation& violation) {
  return violation.file + ":" + std::to_string(violation.line) + ": " + violation.what;
}

}  // namespace forcebound::architecture

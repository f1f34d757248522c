#pragma once

#include <stdexcept>

namespace forcebound::config {

/// A file that cannot be read or is refused: `what()` is one line with file, line, place, what is wrong and what would
/// be accepted; control characters of the file are '?' in it.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace forcebound::config

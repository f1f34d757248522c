#pragma once

#include <stdexcept>

namespace forcebound::handover {

/// A scene handed over that contradicts itself or exceeds a limit. One line: what is wrong, and what is accepted.
class HandoverError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace forcebound::handover

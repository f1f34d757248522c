#pragma once

#include <stdexcept>

namespace forcebound::server {

/// An error in a model of bodies: one line, with the file and MuJoCo's message.
class BodiesError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace forcebound::server

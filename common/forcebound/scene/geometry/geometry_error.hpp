#pragma once

#include <stdexcept>

namespace forcebound::scene {

/// A shape that cannot be made from its input. One line: the file, the place in it, what is wrong.
class GeometryError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace forcebound::scene

#pragma once

#include <initializer_list>

#include "forcebound/control/vector.hpp"

namespace forcebound::test {

inline control::Vector vector_of(std::initializer_list<double> values) {
  control::Vector v(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) v[i++] = value;
  return v;
}

}  // namespace forcebound::test

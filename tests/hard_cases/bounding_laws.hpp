#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "forcebound/control/law_registry.hpp"

namespace forcebound::test {

/// Every shipped law that bounds a force.
inline std::vector<std::string> bounding_laws() {
  std::vector<std::string> names = control::force_bounding_laws().names();
  std::erase(names, "none");
  return names;
}

inline std::string name_of_law(const testing::TestParamInfo<std::string>& law) {
  std::string name = law.param;
  std::erase(name, '-');
  return name;
}

}  // namespace forcebound::test

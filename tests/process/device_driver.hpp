#pragma once

#include <cstdlib>

namespace forcebound::test {

/// While it lives, programs find the drivers for tests. One at a time.
class DriversForTests {
 public:
  DriversForTests() { ::setenv("FORCEBOUND_DEVICE_PATH", FORCEBOUND_TEST_DRIVERS, 1); }
  ~DriversForTests() { ::unsetenv("FORCEBOUND_DEVICE_PATH"); }
  DriversForTests(const DriversForTests&) = delete;
  DriversForTests& operator=(const DriversForTests&) = delete;
};

}  // namespace forcebound::test

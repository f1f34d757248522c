#include "tests/support/drivers/stand_in_library.hpp"

#include <cstdio>
#include <exception>
#include <memory>

namespace forcebound::test {

StandIn* device_of_library() {
  static const std::unique_ptr<StandIn> kDevice = []() -> std::unique_ptr<StandIn> {
    try {
      return stand_in_of_environment();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      return nullptr;
    }
  }();
  return kDevice.get();
}

}  // namespace forcebound::test

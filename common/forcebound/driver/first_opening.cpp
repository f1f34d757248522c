#include "forcebound/driver/first_opening.hpp"

#include <chrono>
#include <stdexcept>
#include <string>

#include "forcebound/child/in_child.hpp"
#include "forcebound/driver/crash.hpp"

namespace forcebound::driver {
namespace {

// Devices are looked for on buses and networks, and may move to find their zero.
constexpr std::chrono::milliseconds kOpenMost{15'000};

}  // namespace

void expect_to_survive(const std::string& file, const DriverRequest& request, const std::function<void()>& open) {
  const auto tried = [&] {
    try {
      open();
    } catch (const std::exception&) {
      return std::string();
    }
    return std::string();
  };
  try {
    (void)child::in_child(tried, {.time = kOpenMost, .opens_files = true});
  } catch (const std::exception& error) {
    // One of a robot is named by its file.
    const std::string where = request.name == file ? "" : " (" + file + ")";
    throw std::runtime_error("driver '" + request.name + "'" + where +
                             ", when it was asked to open its device: " + error.what());
  }
  catch_crashes();
}

}  // namespace forcebound::driver

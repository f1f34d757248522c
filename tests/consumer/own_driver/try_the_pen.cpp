#include <forcebound/driver/driver_family.hpp>

#include <chrono>
#include <cstdio>
#include <exception>

int main() try {
  using namespace std::chrono_literals;
  forcebound::device::DeviceRegistry devices;
  devices.add(forcebound::driver::driver_family({PEN_FOLDER}));
  const auto pen = devices.make({.device = "pen"});
  pen->start();
  for (auto now = 1ms; now < 100ms; now += 1ms) {
    if (!forcebound::device::is_usable(pen->read(now), 1)) return 1;
    pen->apply(now, forcebound::control::Vector::Constant(1, 2.0));
  }
  const double moved_m = pen->read(100ms).position[0];
  pen->stop(100ms);
  std::printf("%s: %g m\n", pen->facts_in_words().c_str(), moved_m);
  return moved_m > 1e-3 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "try_the_pen: %s\n", error.what());
  return 1;
}

// A simulated device as a process of its own, for libraries that stand in for a vendor's: `stand-in-device SOCKET`. It
// runs until SIGINT or SIGTERM, and is set up by the environment (stand_in_device.hpp).
#include <unistd.h>

#include <cstdio>
#include <exception>

#include "forcebound/time/real_time.hpp"
#include "tests/support/drivers/end_signals.hpp"
#include "tests/support/drivers/stand_in_cable.hpp"
#include "tests/support/drivers/stand_in_device.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: stand-in-device SOCKET\n", stderr);
    return 2;
  }
  try {
    const int until = forcebound::test::end_signals();
    // Hardware waits for no program: before its thread is made, which does likewise, and above the client's.
    constexpr int kPriority = 90;
    (void)forcebound::time::ask_for_real_time(kPriority);
    forcebound::test::StandInDevice device(forcebound::test::StandInSettings::from_environment());
    forcebound::test::serve(device, argv[1], until);
    const forcebound::test::StandIn::State end = device.look();
    std::printf("P %.6g J, least P %.6g J\n", end.energy_J, end.least_energy_J);
    ::close(until);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stand-in-device: %s\n", error.what());
    return 1;
  }
  return 0;
}

#pragma once

namespace forcebound::ros2 {

/// forcebound-ros2: reads the command line and runs until its time is up or a signal ends it. @returns the exit code
int run_program(int argc, const char* const* argv);

}  // namespace forcebound::ros2

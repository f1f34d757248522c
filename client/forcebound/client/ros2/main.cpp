#include "forcebound/client/ros2/ros2_program.hpp"

int main(int argc, char** argv) { return forcebound::ros2::run_program(argc, argv); }

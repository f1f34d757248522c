#include "tests/tools/relay/relay_program.hpp"

int main(int argc, char** argv) { return forcebound::relay::run_program(argc, argv); }

#include "forcebound/server/app/server_program.hpp"

int main(int argc, char** argv) { return forcebound::server::run_program(argc, argv); }

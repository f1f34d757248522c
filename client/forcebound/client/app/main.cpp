#include "forcebound/client/app/client_program.hpp"

int main(int argc, char** argv) { return forcebound::client::run_program(argc, argv); }

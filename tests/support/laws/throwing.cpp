// A law in C++ that throws where the interface is C's.
#include <stdexcept>

#include "forcebound/law_plugin/forcebound_law.h"

struct forcebound_law {
  int ticks = 0;
};

namespace {

int create(const forcebound_law_facts* facts, const double* /*parameters*/, forcebound_law** law, char* /*error*/,
           size_t /*error_bytes*/) {
  if (facts->degrees_of_freedom == 3) throw std::runtime_error("three axes are too many");
  *law = new forcebound_law;
  return FORCEBOUND_LAW_OK;
}

int tick(forcebound_law* law, const forcebound_law_reading* /*reading*/, const forcebound_law_request* request,
         forcebound_law_force* force) {
  force->force_N[0] = request->force_N[0];
  if (++law->ticks == 2) throw 42;
  return FORCEBOUND_LAW_OK;
}

void destroy(forcebound_law* law) { delete law; }

const forcebound_law_functions kThrowing = [] {
  forcebound_law_functions functions{};
  functions.size = sizeof functions;
  functions.interface_version = FORCEBOUND_LAW_INTERFACE;
  functions.name = "throwing";
  functions.create = create;
  functions.tick = tick;
  functions.destroy = destroy;
  return functions;
}();

}  // namespace

const forcebound_law_functions* forcebound_law_entry(uint32_t /*wanted*/) { return &kThrowing; }

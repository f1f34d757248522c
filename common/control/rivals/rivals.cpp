#include "forcebound/control/rivals/rivals.hpp"

namespace forcebound::control {

void add_rivals(LawRegistry& laws) {
  laws.add(memory_based_passivation());
  laws.add(successive_force_augment());
  laws.add(virtual_coupling());
}

}  // namespace forcebound::control

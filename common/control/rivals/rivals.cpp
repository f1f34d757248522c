#include "forcebound/control/rivals/rivals.hpp"

namespace forcebound::control {

void add_rivals(LawRegistry& laws) {
  laws.add(adjusting_output_limiter());
  laws.add(energy_bounding());
  laws.add(memory_based_passivation());
  laws.add(set_position_modulation());
  laws.add(successive_force_augment());
  laws.add(time_domain_passivity());
  laws.add(two_port_passivity());
  laws.add(two_layer());
  laws.add(virtual_coupling());
  laws.add(wave_variables());
}

}  // namespace forcebound::control

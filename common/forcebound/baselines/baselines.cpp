#include "forcebound/baselines/baselines.hpp"

#include "forcebound/baselines/later_laws.hpp"

namespace forcebound::baselines {

void add_baselines(control::LawRegistry& laws) {
  laws.add(adjusting_output_limiter());
  laws.add(energy_bounding());
  laws.add(input_to_state_stability());
  laws.add(memory_based_passivation());
  laws.add(set_position_modulation());
  laws.add(successive_force_augment());
  laws.add(time_domain_passivity());
  laws.add(two_port_passivity());
  laws.add(energy_reflection());
  laws.add(prioritised_dissipation());
  laws.add(two_layer());
  laws.add(virtual_coupling());
  laws.add(wave_variables());
}

control::LawRegistry shipped_laws() {
  control::LawRegistry laws = control::force_bounding_laws();
  add_baselines(laws);
  return laws;
}

}  // namespace forcebound::baselines

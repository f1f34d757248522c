#include "forcebound/control/rivals/rivals.hpp"

namespace forcebound::control {

void add_rivals(LawRegistry& laws) {
  laws.add(set_position_modulation());
  laws.add(two_layer());
  laws.add(two_port_passivity());
  laws.add(wave_variables());
}

}  // namespace forcebound::control

#include "forcebound/control/rivals/rivals.hpp"

namespace forcebound::control {

void add_rivals(LawRegistry& laws) {
  laws.add(adjusting_output_limiter());
  laws.add(energy_bounding());
  laws.add(time_domain_passivity());
}

}  // namespace forcebound::control

#include "forcebound/control/rivals/rivals.hpp"

namespace forcebound::control {

void add_rivals(LawRegistry& laws) { (void)laws; }

}  // namespace forcebound::control

#include "forcebound/server/dynamics/bodies/mjcf_check.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

// MuJoCo itself is not ours, and runs in a child process.
void fuzz_mjcf(Bytes bytes) {
  may_refuse([&] { server::check_mjcf(text_of(bytes)); });
}

}  // namespace forcebound::fuzz

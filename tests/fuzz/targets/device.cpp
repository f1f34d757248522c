#include "forcebound/device/load_device.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_device(Bytes bytes) {
  may_refuse([&] { (void)device::parse_device(text_of(bytes), "device.toml"); });
}

}  // namespace forcebound::fuzz

#include "forcebound/config/node.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_toml(Bytes bytes) {
  may_refuse([&] { (void)config::written(config::parse_toml(text_of(bytes), "file.toml")); });
  may_refuse([&] { (void)config::written(config::parse_toml_value(text_of(bytes), 1)); });
}

}  // namespace forcebound::fuzz

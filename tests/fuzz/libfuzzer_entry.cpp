#include <cstdint>

#include "tests/fuzz/targets.hpp"

// libFuzzer calls it by this name. FORCEBOUND_FUZZ_TARGET is the function of the program's one target.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t bytes);  // NOLINT

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t bytes) {  // NOLINT
  forcebound::fuzz::FORCEBOUND_FUZZ_TARGET(std::as_bytes(std::span(data, bytes)));
  return 0;
}

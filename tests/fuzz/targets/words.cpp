#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/net/endpoint.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/tools/netem/netem_parameters.hpp"

namespace forcebound::fuzz {

void fuzz_words(Bytes bytes) {
  const std::string_view words = text_of(bytes);
  may_refuse([&] { (void)netem::parse_netem(words); });
  may_refuse([&] { (void)net::parse_endpoint(words); });
  may_refuse([&] { (void)net::parse_peer(words); });
  // A recorded hand would open any file.
  if (words.starts_with("replay")) return;
  may_refuse([&] { (void)device::make_operator(std::string(words), 3); });
}

}  // namespace forcebound::fuzz

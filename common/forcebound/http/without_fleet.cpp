// In place of client.cpp in a build with FORCEBOUND_FLEET=OFF, which needs neither Boost.Beast here nor OpenSSL.
#include <stdexcept>

#include "forcebound/http/client.hpp"

namespace forcebound::http {

std::string_view refusal() noexcept {
  return "this program was built without fleets of servers (FORCEBOUND_FLEET=OFF)";
}

Response ask(const Url& url, const Request& /*request*/, std::chrono::nanoseconds /*limit*/,
             const Certificates& /*certificates*/) {
  throw std::runtime_error(url.text() + ": " + std::string(refusal()));
}

}  // namespace forcebound::http

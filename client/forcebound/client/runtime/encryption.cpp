#include "forcebound/client/runtime/encryption.hpp"

#include <chrono>
#include <new>

#include "forcebound/security/random.hpp"

namespace forcebound::client {
namespace {

constexpr Nanoseconds kHandshakePause = std::chrono::milliseconds{2};

}  // namespace

Encryption::Encryption(const IdentityFiles& files, const std::string& server_name, net::DatagramLink& link,
                       const net::Address& server, const time::Clock& clock)
    : clock_(clock),
      handshaker_(read_identity(files, server_name, security::fill_with_random), security::fill_with_random),
      link_(link, server, handshaker_, clock),
      thread_([this](const std::stop_token& ended) { work(ended); }) {}

void Encryption::work(const std::stop_token& ended) {
  while (!ended.stop_requested()) {
    try {
      handshaker_.work(clock_.now());
    } catch (const std::bad_alloc&) {  // begun again when there is memory
    }
    std::this_thread::sleep_for(kHandshakePause);
  }
}

}  // namespace forcebound::client

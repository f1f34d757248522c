#include <algorithm>
#include <array>
#include <cstddef>
#include <variant>

#include "forcebound/security/allowed_clients.hpp"
#include "forcebound/security/handshake_datagram.hpp"
#include "forcebound/security/key_file.hpp"
#include "forcebound/security/keys.hpp"
#include "forcebound/security/known_servers.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {
namespace {

/// What was read is written as it was, but for what is padding.
void read_and_write(Bytes datagram) {
  const auto read = security::read_handshake(datagram);
  std::array<std::byte, security::kRequestBytes> written{};
  std::size_t bytes = 0;
  if (const auto* request = std::get_if<security::HandshakeRequest>(&read)) bytes = write(*request, written);
  if (const auto* offer = std::get_if<security::CookieOffer>(&read)) bytes = write(*offer, written);
  if (const auto* answer = std::get_if<security::HandshakeAnswer>(&read)) bytes = write(*answer, written);
  must(std::holds_alternative<std::monostate>(read) == (bytes == 0), "what was read cannot be written");
  must(bytes <= datagram.size() &&
           std::equal(written.begin(), written.begin() + static_cast<std::ptrdiff_t>(bytes), datagram.begin()),
       "what was read is written as something else");
}

}  // namespace

void fuzz_keys(Bytes bytes) {
  static InputFile file("keys");
  Script script(bytes);
  const std::uint8_t kind = script.byte();
  const Bytes rest = script.take(bytes.size());
  constexpr std::uint8_t kKinds = 6;
  switch (kind % kKinds) {
    case 0:
      file.replace(rest);
      return may_refuse([&] { (void)security::KnownServers::from_file(file.path()); });
    case 1:
      return may_refuse([&] { (void)security::AllowedClients::parse(text_of(rest), "clients.toml"); });
    case 2:
      file.replace(rest);
      return may_refuse([&] { (void)security::read_key_pair(file.path()); });
    case 3:
      file.replace(rest);
      return may_refuse([&] { (void)security::read_shared_key(file.path()); });
    case 4: {
      const auto key = security::public_key_from(text_of(rest));
      must(!key || text_of(rest).ends_with(security::to_base64(key->bytes)),
           "a key is written as something else than was read");
      return;
    }
    default:
      return read_and_write(rest);
  }
}

}  // namespace forcebound::fuzz

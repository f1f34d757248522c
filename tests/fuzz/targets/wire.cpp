#include "forcebound/wire/codec.hpp"
#include "tests/fuzz/frame.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_wire(Bytes bytes) {
  static wire::Codec reader;
  static wire::Codec writer;
  (void)reader.decode(bytes);

  Script script(bytes);
  const std::uint8_t kind = script.byte();
  const auto decoded = reader.decode(framed(kind, script.take(bytes.size())));
  const auto* const message = std::get_if<wire::Message>(&decoded);
  if (message == nullptr) return;
  // What one codec takes, the next does as well.
  const Bytes again = writer.encode(*message);
  must(again.size() <= wire::kFrameBytesMax, "a datagram longer than the protocol allows");
  const std::size_t index = message->index();
  const auto decoded_again = reader.decode(again);
  const auto* const same = std::get_if<wire::Message>(&decoded_again);
  must(same != nullptr && same->index() == index, "a message that was read cannot be written and read again");
}

}  // namespace forcebound::fuzz

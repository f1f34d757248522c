#include <zlib.h>
#include <zstd.h>

#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "forcebound/record/mcap_reader.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {
namespace {

using record::mcap::Opcode;

std::string compressed(std::string_view records) {
  std::string frame(ZSTD_compressBound(records.size()), '\0');
  const std::size_t size = ZSTD_compress(frame.data(), frame.size(), records.data(), records.size(), 1);
  must(ZSTD_isError(size) == 0, "zstd does not compress");
  frame.resize(size);
  return frame;
}

/// A file of one chunk.
std::string file_of(std::uint64_t size, std::uint32_t crc, std::string_view frame) {
  using record::mcap::put;
  std::string content;
  put(content, std::uint64_t{0});
  put(content, std::uint64_t{0});
  put(content, size);
  put(content, crc);
  put(content, std::string_view("zstd"));
  put(content, static_cast<std::uint64_t>(frame.size()));
  content += frame;
  std::string file(record::mcap::kMagic);
  put_record(file, Opcode::chunk, content);
  put_record(file, Opcode::footer, std::string(20, '\0'));
  return file += record::mcap::kMagic;
}

/// @returns the messages; nothing: the file was refused
std::optional<std::uint64_t> messages_of(const std::string& file) {
  std::istringstream in(file);
  std::uint64_t messages = 0;
  record::mcap::Visitor visitor;
  visitor.message = [&](const auto&, const auto&, const auto&) { ++messages; };
  bool whole = false;
  may_refuse([&] {
    (void)read(in, "f.mcap", visitor);
    whole = true;
  });
  return whole ? std::optional(messages) : std::nullopt;
}

}  // namespace

// The first byte says what follows: the records of a chunk, which are compressed and their checksum made right, since
// no random change would get past both; or four bytes of the size that the chunk says, and a frame.
void fuzz_compressed_recording(Bytes bytes) {
  constexpr std::size_t kHead = 5;
  if (bytes.empty()) return;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if ((static_cast<unsigned char>(text[0]) & 1U) == 0) {
    const std::string_view records = text.substr(1);
    const auto crc =
        static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size()));
    const std::string file = file_of(records.size(), crc, compressed(records));
    const auto messages = messages_of(file);
    const auto of_half = messages_of(file.substr(0, file.size() / 2));
    must(!messages || !of_half || *of_half <= *messages, "half of a file has more messages");
    return;
  }
  if (bytes.size() < kHead) return;
  std::uint64_t size = 0;
  for (std::size_t i = kHead; i-- > 1;) size = size << 8U | static_cast<unsigned char>(text[i]);
  (void)messages_of(file_of(size, 0, text.substr(kHead)));
}

}  // namespace forcebound::fuzz

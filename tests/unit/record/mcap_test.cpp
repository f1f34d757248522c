#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/record/mcap_reader.hpp"
#include "forcebound/record/mcap_writer.hpp"

namespace forcebound::record::mcap {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::uint64_t kSecond = 1'000'000'000;

std::string payload_of(std::uint32_t number) {
  return "message " + std::to_string(number) + std::string(100 + number % 7, static_cast<char>('a' + number % 26));
}

/// Some metadata, an attachment, then messages, 1,000 of them in a chunk.
std::string file_of(std::uint32_t messages, Compression compression) {
  std::ostringstream out;
  Writer writer(out, "test", compression);
  writer.add_metadata("first", {{"key", "value"}});
  writer.add_attachment("scene.toml", "application/toml", 7, "name = \"wall\"\n");
  const std::uint16_t channel = writer.add_channel("/topic", "schema", "none", "", "none");
  for (std::uint32_t number = 0; number < messages; ++number) {
    writer.write(channel, number, kSecond + std::uint64_t{number} * (kSecond / 1000), payload_of(number));
  }
  writer.add_metadata("last", {});
  writer.close();
  return out.str();
}

struct Contents {
  std::uint32_t messages = 0;
  std::vector<std::string> metadata{};
  std::vector<std::string> attachments{};
  Ending ending{};
};

/// Checks every message against what was written, in order.
Contents read_all(const std::string& bytes) {
  Contents contents;
  std::istringstream in(bytes);
  Visitor visitor;
  visitor.message = [&](const Schema&, const Channel& channel, const Message& message) {
    EXPECT_EQ(channel.topic, "/topic");
    EXPECT_EQ(message.sequence, contents.messages);
    EXPECT_EQ(message.data, payload_of(contents.messages));
    ++contents.messages;
  };
  visitor.metadata = [&](const std::string& name, const auto&) { contents.metadata.push_back(name); };
  visitor.attachment = [&](const Attachment& attachment) {
    contents.attachments.push_back(attachment.name + "|" + attachment.media_type + "|" + std::string(attachment.data));
  };
  contents.ending = read(in, "f.mcap", visitor);
  return contents;
}

/// What is said of a file that is refused, or not whole.
std::string fault_of(const std::string& bytes) {
  try {
    return in_words(read_all(bytes).ending);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

struct Piece {
  Opcode opcode;
  std::uint64_t begin;
  std::uint64_t end;
};

/// The records of a file, chunks whole.
std::vector<Piece> pieces_of(const std::string& bytes) {
  std::vector<Piece> pieces;
  std::uint64_t at = kMagic.size();
  while (at + kMagic.size() < bytes.size()) {
    std::uint64_t length = 0;
    for (int i = 8; i >= 1; --i) length = length << 8U | static_cast<unsigned char>(bytes[at + i]);
    pieces.push_back({Opcode{static_cast<std::uint8_t>(bytes[at])}, at, at + kRecordHeaderBytes + length});
    at = pieces.back().end;
  }
  return pieces;
}

/// A file whose only record is a chunk with such a head.
std::string chunk_file(std::uint64_t size, std::uint32_t crc, std::string_view compression, std::string_view records) {
  std::string content;
  put(content, std::uint64_t{0});
  put(content, std::uint64_t{0});
  put(content, size);
  put(content, crc);
  put(content, compression);
  put(content, static_cast<std::uint64_t>(records.size()));
  content += records;
  std::string file(kMagic);
  put_record(file, Opcode::chunk, content);
  put_record(file, Opcode::footer, std::string(20, '\0'));
  return file + std::string(kMagic);
}

std::string frame_of(std::string_view bytes) {
  std::string frame(ZSTD_compressBound(bytes.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), 1));
  return frame;
}

TEST(Mcap, CompressedIsReadAsUncompressedIsAndIsSmaller) {
  const std::string plain = file_of(3000, Compression::none);
  const std::string compressed = file_of(3000, Compression::zstd);
  EXPECT_LT(compressed.size(), plain.size() / 2);
  for (const std::string& bytes : {plain, compressed}) {
    const Contents contents = read_all(bytes);
    EXPECT_TRUE(contents.ending);
    EXPECT_EQ(contents.ending.whole + kMagic.size(), bytes.size());
    EXPECT_EQ(in_words(contents.ending), "");
    EXPECT_EQ(contents.messages, 3000U);
    EXPECT_EQ(contents.metadata, (std::vector<std::string>{"first", "last"}));
    EXPECT_EQ(contents.attachments, (std::vector<std::string>{"scene.toml|application/toml|name = \"wall\"\n"}));
  }
  const Ending ending = read_all(compressed).ending;
  EXPECT_EQ(ending.uncompressed, read_all(plain).ending.stored);
  EXPECT_LT(ending.stored, compressed.size());
}

TEST(Mcap, ThatCompressionMakesNoSmallerIsLeftAsItIs) {
  std::mt19937_64 random(3);
  std::string noise;
  for (int i = 0; i < 4096; ++i) put(noise, static_cast<std::uint64_t>(random()));
  std::ostringstream out;
  Writer writer(out, "test");
  writer.write(writer.add_channel("/noise", "s", "none", "", "none"), 0, 0, noise);
  writer.close();
  EXPECT_THAT(out.str(), HasSubstr(noise));
  EXPECT_TRUE([&] {
    std::istringstream in(out.str());
    return read(in, "f.mcap", {}).complete;
  }());
}

// Every boundary of records, and the bytes before and behind it.
TEST(Mcap, CutAtEveryRecordIsReadUpToThereAndSaysWhere) {
  for (const Compression compression : {Compression::none, Compression::zstd}) {
    const std::string bytes = file_of(2500, compression);
    std::uint32_t whole_messages = 0;
    for (const Piece& piece : pieces_of(bytes)) {
      SCOPED_TRACE(piece.begin);
      const Contents at = read_all(bytes.substr(0, piece.begin));
      EXPECT_FALSE(at.ending);
      EXPECT_EQ(at.ending.whole, piece.begin);
      EXPECT_EQ(at.messages, whole_messages);
      EXPECT_THAT(in_words(at.ending), StartsWith("it ends at byte " + std::to_string(piece.begin) + ", "));

      const Contents behind = read_all(bytes.substr(0, piece.begin + 1));
      EXPECT_FALSE(behind.ending);
      EXPECT_EQ(behind.ending.whole, piece.begin);
      EXPECT_EQ(behind.messages, whole_messages);

      const Contents before = read_all(bytes.substr(0, piece.end - 1));
      EXPECT_FALSE(before.ending);
      EXPECT_EQ(before.ending.whole, piece.begin);
      EXPECT_EQ(before.ending.kind, name_of(piece.opcode));
      if (piece.opcode == Opcode::chunk) {
        EXPECT_EQ(before.ending.rescued, before.messages - whole_messages);
        whole_messages = read_all(bytes.substr(0, piece.end)).messages;
        EXPECT_LE(before.messages, whole_messages);
        EXPECT_THAT(in_words(before.ending), HasSubstr(", within a chunk of "));
      } else {
        EXPECT_EQ(before.messages, whole_messages);
      }
    }
    EXPECT_EQ(whole_messages, 2500U);
  }
}

TEST(Mcap, CutAnywhereLosesNoMessageThatIsWholeInTheFile) {
  const std::string bytes = file_of(2500, Compression::none);
  std::mt19937 random(11);
  for (int round = 0; round < 200; ++round) {
    const std::size_t length = kMagic.size() + random() % (bytes.size() - kMagic.size());
    SCOPED_TRACE(length);
    const Contents contents = read_all(bytes.substr(0, length));
    EXPECT_FALSE(contents.ending);
    EXPECT_EQ(contents.ending.size, length);
    std::uint32_t in_file = 0;  // payloads end before the cut
    for (std::size_t at = 0; in_file < 2500; ++in_file) {
      at = bytes.find(payload_of(in_file), at);
      if (at + payload_of(in_file).size() > length) break;
    }
    EXPECT_EQ(contents.messages, in_file);
  }
}

// As that of a run that goes on: what comes while it is read is left out.
TEST(Mcap, ThatGrowsIsReadAsFarAsItWentAtFirst) {
  const std::string bytes = file_of(2500, Compression::none);
  const auto pieces = pieces_of(bytes);
  const auto first = std::ranges::find(pieces, Opcode::metadata, &Piece::opcode);
  ASSERT_NE(first, pieces.end());
  for (const std::size_t more : {0, 4, 9}) {
    SCOPED_TRACE(more);
    std::stringstream file(bytes.substr(0, first->end + more));
    Visitor visitor;
    visitor.metadata = [&](const std::string&, const auto&) {
      file.seekp(0, std::ios::end);
      file << bytes.substr(first->end + more);
    };
    const Ending ending = read(file, "f.mcap", visitor);
    EXPECT_EQ(ending.messages, 0U);
    EXPECT_EQ(ending.whole, first->end);
    EXPECT_EQ(ending.size, first->end + more);
  }
}

TEST(Mcap, CutWithinACompressedChunkGivesItsWholeBlocks) {
  std::ostringstream out;
  Writer writer(out, "test");
  const std::uint16_t channel = writer.add_channel("/topic", "schema", "none", "", "none");
  for (std::uint32_t number = 0; number < 20000; ++number) writer.write(channel, number, 0, payload_of(number));
  writer.close();
  const std::string bytes = out.str();
  const Piece chunk = pieces_of(bytes).at(1);
  ASSERT_EQ(chunk.opcode, Opcode::chunk);
  std::uint32_t most = 0;
  for (std::uint64_t cut = chunk.begin; cut < chunk.end; cut += 1 + (chunk.end - chunk.begin) / 97) {
    const Contents contents = read_all(bytes.substr(0, cut));
    EXPECT_EQ(contents.ending.rescued, contents.messages);
    EXPECT_GE(contents.messages, most);  // never fewer of a longer part
    most = contents.messages;
  }
  EXPECT_GT(most, 15000U);
}

TEST(Mcap, ThatLacksOnlyItsIndexSaysSo) {
  const std::string bytes = file_of(10, Compression::zstd);
  for (const std::size_t lost : {1, 8, 9, 30, 100}) {
    const Contents contents = read_all(bytes.substr(0, bytes.size() - lost));
    EXPECT_FALSE(contents.ending);
    EXPECT_EQ(contents.messages, 10U);
    EXPECT_THAT(in_words(contents.ending),
                EndsWith(", within the index behind its last record: all records are there"));
  }
}

TEST(Mcap, ThatEndsInZerosIsReadUpToThem) {
  const std::string bytes = file_of(1500, Compression::zstd);
  const Piece last = pieces_of(bytes).back();
  const Contents contents = read_all(bytes.substr(0, last.begin) + std::string(4096, '\0'));
  EXPECT_FALSE(contents.ending);
  EXPECT_EQ(contents.messages, 1500U);
}

TEST(Mcap, ThatEndsInZerosWithinAChunkIsReadUpToThem) {
  const std::string bytes = file_of(1500, Compression::none);
  const std::vector<Piece> pieces = pieces_of(bytes);
  const auto chunk = std::ranges::find(pieces, Opcode::chunk, &Piece::opcode);
  const std::uint64_t kept = (chunk->end - chunk->begin) / 2;
  const Contents contents = read_all(bytes.substr(0, chunk->begin + kept) + std::string(kept / 2, '\0'));
  EXPECT_FALSE(contents.ending);
  EXPECT_GT(contents.messages, 400U);
  EXPECT_EQ(contents.ending.rescued, contents.messages);
}

TEST(Mcap, RefusesNamesThatWouldFillTheMemory) {
  std::string content;
  put(content, std::uint16_t{1});
  put(content, std::string_view(std::string(1025, 'n')));
  put(content, std::string_view("protobuf"));
  put(content, std::string_view());
  std::string file(kMagic);
  put_record(file, Opcode::schema, content);
  EXPECT_THAT(fault_of(file), StartsWith("1 damaged record (at byte 19: a name of 1025 bytes; accepted are at most "
                                         "1024); it ends at byte"));
}

TEST(Mcap, RefusesACompressedChunkThatSaysThatItIsHuge) {
  const std::string frame = frame_of(std::string(100, 'x'));
  for (const std::uint64_t size : {std::uint64_t{kChunkBytesMost} + 1, std::uint64_t{1} << 40U, ~std::uint64_t{0}}) {
    EXPECT_EQ(fault_of(chunk_file(size, 0, "zstd", frame)),
              "1 damaged record (at byte 17: a compressed chunk that would hold " + std::to_string(size) +
                  " bytes; accepted are at most 67108864)");
  }
}

TEST(Mcap, RefusesACompressedChunkThatHoldsMoreOrLessThanItSays) {
  std::string records;
  put_record(records, Opcode::message_index, std::string(1000, 'x'));
  const std::string frame = frame_of(records);
  EXPECT_EQ(fault_of(chunk_file(records.size(), 0, "zstd", frame)), "");
  EXPECT_THAT(fault_of(chunk_file(records.size() + 1, 0, "zstd", frame)),
              HasSubstr("byte 17: a compressed chunk that holds 1009 bytes, where it says 1010"));
  EXPECT_THAT(fault_of(chunk_file(records.size() - 1, 0, "zstd", frame)), HasSubstr("holds more than it says"));
  EXPECT_THAT(fault_of(chunk_file(0, 0, "zstd", frame)), HasSubstr("holds more than it says"));
}

TEST(Mcap, RefusesACompressedChunkThatIsNoFrameOrCutOffOrFollowedByMore) {
  std::string records;
  put_record(records, Opcode::message_index, std::string(1000, 'x'));
  const std::string frame = frame_of(records);
  EXPECT_THAT(fault_of(chunk_file(records.size(), 0, "zstd", "no frame at all")),
              HasSubstr("byte 17: the compressed chunk is damaged: "));
  EXPECT_THAT(fault_of(chunk_file(records.size(), 0, "zstd", "")), HasSubstr("the frame is cut off"));
  EXPECT_THAT(fault_of(chunk_file(records.size(), 0, "zstd", frame.substr(0, frame.size() - 1))),
              HasSubstr("the frame is cut off"));
  EXPECT_THAT(fault_of(chunk_file(records.size(), 0, "zstd", frame + "x")), HasSubstr("bytes follow its end"));
}

TEST(Mcap, RefusesWrongChecksumsNamingBoth) {
  std::string records;
  put_record(records, Opcode::message_index, std::string(1000, 'x'));
  const auto crc = static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(records.data()), static_cast<uInt>(records.size())));
  EXPECT_EQ(fault_of(chunk_file(records.size(), crc, "zstd", frame_of(records))), "");
  EXPECT_THAT(fault_of(chunk_file(records.size(), crc + 1, "zstd", frame_of(records))),
              AllOf(HasSubstr("byte 17: the chunk is damaged: its CRC-32 is 0x"), HasSubstr(", the file says 0x")));
  std::string bytes = file_of(1, Compression::zstd);
  bytes[bytes.find("name = ")] ^= 1;
  EXPECT_THAT(fault_of(bytes), HasSubstr("the attachment is damaged: its CRC-32 is 0x"));
}

TEST(Mcap, RefusesOtherCompressionsAndRecordsThatThereAreNot) {
  EXPECT_THAT(fault_of(chunk_file(10, 0, "lz4", "0123456789")),
              HasSubstr("a chunk compressed with 'lz4'; accepted are zstd and none"));
  EXPECT_THAT(fault_of(chunk_file(4096, 0, "zstd", frame_of(std::string(4096, '\0')))),
              HasSubstr("byte 17: a record of kind 0, which there is not"));
}

/// The numbers of the messages in each chunk of a file, in the file's order: [first, last).
std::vector<std::pair<std::uint32_t, std::uint32_t>> messages_by_chunk(const std::string& bytes) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> all;
  std::uint32_t before = 0;
  for (const Piece& piece : pieces_of(bytes)) {
    if (piece.opcode != Opcode::chunk) continue;
    const std::uint32_t until = read_all(bytes.substr(0, piece.end)).messages;
    all.emplace_back(before, until);
    before = until;
  }
  return all;
}

/// What is visited of a file that is not whole: the numbers of its messages.
struct Rest {
  std::vector<std::uint32_t> messages{};
  int others = 0;  ///< metadata and attachments
  Ending ending{};
};

Rest rest_of(const std::string& bytes) {
  Rest rest;
  std::istringstream in(bytes);
  Visitor visitor;
  visitor.message = [&](const Schema& schema, const Channel& channel, const Message& message) {
    EXPECT_EQ(schema.name, "schema");
    EXPECT_EQ(channel.topic, "/topic");
    EXPECT_EQ(message.data, payload_of(message.sequence)) << "a message that is not as it was written";
    rest.messages.push_back(message.sequence);
  };
  visitor.metadata = [&](const std::string&, const auto&) { ++rest.others; };
  visitor.attachment = [&](const Attachment& attachment) {
    EXPECT_EQ(attachment.data, "name = \"wall\"\n");
    ++rest.others;
  };
  rest.ending = read(in, "f.mcap", visitor);
  return rest;
}

/// The messages of `all` that are not in `rest`, by chunk.
std::size_t chunks_lost(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& chunks,
                        const std::vector<std::uint32_t>& rest) {
  std::size_t lost = 0;
  std::size_t there = 0;
  for (const auto& [first, last] : chunks) {
    const auto from = std::ranges::lower_bound(rest, first);
    const auto count = static_cast<std::uint32_t>(std::ranges::lower_bound(rest, last) - from);
    EXPECT_TRUE(count == 0 || count == last - first) << "part of a chunk: " << count << " of " << last - first;
    lost += count == 0 ? 1U : 0U;
    there += count;
  }
  EXPECT_EQ(there, rest.size());
  return lost;
}

// The bytes of a small file, inverted or with their highest or lowest bit changed, an opcode or a length in all three
// ways: of three chunks at most the one is lost that the byte is in; nothing is shown that was not written, and all of
// it is said.
TEST(Mcap, WithAnyByteChangedLosesAtMostTheChunkItIsInAndSaysSo) {
  for (const Compression compression : {Compression::none, Compression::zstd}) {
    const std::string bytes = file_of(2100, compression);
    const auto chunks = messages_by_chunk(bytes);
    ASSERT_EQ(chunks.size(), 3U);
    const std::vector<Piece> pieces = pieces_of(bytes);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      const auto piece = std::ranges::find_if(pieces, [at](const Piece& p) { return p.begin <= at && at < p.end; });
      const bool in_chunk = piece != pieces.end() && piece->opcode == Opcode::chunk;
      // Behind a record's head one byte is as good as another.
      constexpr std::size_t kHead = 60;
      constexpr std::size_t kStep = 401;
      if (piece != pieces.end() && at > piece->begin + kHead && at + kHead < piece->end && at % kStep != 0) continue;
      constexpr std::array kChanges{0xFFU, 0x80U, 0x01U};
      constexpr std::size_t kOpcodeAndLength = 9;
      const bool decides = piece != pieces.end() && at < piece->begin + kOpcodeAndLength;
      for (std::size_t way = 0; way < kChanges.size(); ++way) {
        if (!decides && way != at % kChanges.size()) continue;
        const unsigned change = kChanges[way];
        SCOPED_TRACE(testing::Message() << "byte " << at << " ^ " << change);
        std::string damaged = bytes;
        damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^ change);
        const Rest rest = rest_of(damaged);
        const std::size_t lost = chunks_lost(chunks, rest.messages);
        ASSERT_LE(lost, in_chunk ? 1U : 0U);
        ASSERT_GE(rest.others, in_chunk ? 3 : 2);
        ASSERT_EQ(in_words(rest.ending).empty(), static_cast<bool>(rest.ending));
        if (lost > 0) {
          ASSERT_EQ(rest.ending.damaged, 1U);
          ASSERT_THAT(in_words(rest.ending), StartsWith("1 damaged record, with "));
          ASSERT_THAT(in_words(rest.ending), HasSubstr(" of 2100 messages (at byte "));
        }
      }
    }
  }
}

// A killed process leaves no index: where a damaged record ends is then found by the next one.
TEST(Mcap, WithoutItsIndexLosesAtMostTheChunkOfAChangedByteBehindTheFirst) {
  for (const Compression compression : {Compression::none, Compression::zstd}) {
    const std::string whole = file_of(2100, compression);
    const std::vector<Piece> pieces = pieces_of(whole);
    const auto end = std::ranges::find(pieces, Opcode::data_end, &Piece::opcode);
    const std::string bytes = whole.substr(0, end->begin);
    const auto chunks = messages_by_chunk(whole);
    int chunk = 0;
    for (const Piece& piece : pieces) {
      if (piece.opcode != Opcode::chunk || ++chunk == 1) continue;  // the first declares the channels
      for (std::size_t at = piece.begin; at < piece.end; at += at < piece.begin + 60 ? 1 : 997) {
        SCOPED_TRACE(at);
        std::string damaged = bytes;
        damaged[at] = static_cast<char>(~damaged[at]);
        const Rest rest = rest_of(damaged);
        ASSERT_LE(chunks_lost(chunks, rest.messages), 1U);
        ASSERT_FALSE(rest.ending);
      }
    }
  }
}

TEST(Mcap, GoesOnBehindARecordThatItsVisitorFindsWrong) {
  const std::string bytes = file_of(2100, Compression::zstd);
  std::istringstream in(bytes);
  std::uint32_t visited = 0;
  Visitor visitor;
  visitor.message = [&](const Schema&, const Channel&, const Message& message) {
    if (message.sequence % 1000 == 7) throw std::invalid_argument("not as I want it");
    ++visited;
  };
  const Ending ending = read(in, "f.mcap", visitor);
  EXPECT_EQ(visited, 2097U);
  EXPECT_EQ(ending.damaged, 3U);
  EXPECT_THAT(in_words(ending), AllOf(StartsWith("3 damaged records, with 3 of 2100 messages (the first at byte "),
                                      EndsWith(": not as I want it)")));
}

}  // namespace
}  // namespace forcebound::record::mcap

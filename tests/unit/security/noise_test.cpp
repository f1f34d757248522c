#include "forcebound/security/noise.hpp"

#include <gmock/gmock.h>
#include <sodium.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/security/internal/nonce.hpp"
#include "forcebound/security/internal/raw.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::security {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;
using testing::ThrowsMessage;

using Bytes = std::vector<std::byte>;

Bytes from_hex(std::string_view hex) {
  Bytes bytes;
  bytes.reserve(hex.size() / 2);
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
  }
  return bytes;
}

KeyBytes key_from_hex(std::string_view hex) {
  KeyBytes key{};
  std::ranges::copy(from_hex(hex), key.begin());
  return key;
}

SecretKey secret_from_hex(std::string_view hex) {
  SecretKey key;
  *key = key_from_hex(hex);
  return key;
}

/// Of vectors/cacophony.txt in github.com/haskell-cryptography/cacophony, which is in the public domain.
struct Vector {
  Pattern pattern;
  std::string_view hash;
  std::array<std::string_view, 6> messages;
};

constexpr std::string_view kPrologue = "4a6f686e2047616c74";
constexpr std::string_view kShared = "54686973206973206d7920417573747269616e20706572737065637469766521";
constexpr std::string_view kInitiatorStatic = "e61ef9919cde45dd5f82166404bd08e38bceb5dfdfded0a34c8df7ed542214d1";
constexpr std::string_view kInitiatorEphemeral = "893e28b9dc6ca8d611ab664754b8ceb7bac5117349a4439a6b0569da977c464a";
constexpr std::string_view kResponderStatic = "4a3acbfdb163dec651dfa3194dece676d437029c62a408b4c5ea9114246e4893";
constexpr std::string_view kResponderPublic = "31e0303fd6418d2f8c0e78b91f22e8caed0fbe48656dcf4767e4834f701b8f62";
constexpr std::string_view kResponderEphemeral = "bbdb4cdbd309f1a1f2e1456967fe288cadd6f712d65dc7b7793d5e63da6b375b";
constexpr std::array<std::string_view, 2> kHandshakePayloads{"4c756477696720766f6e204d69736573",
                                                             "4d757272617920526f746862617264"};
constexpr std::array<std::string_view, 4> kLaterPayloads{"462e20412e20486179656b", "4361726c204d656e676572",
                                                         "4a65616e2d426170746973746520536179",
                                                         "457567656e2042f6686d20766f6e2042617765726b"};

constexpr Vector kIkVector{
    Pattern::ik_psk2,
    "ed837c9084f2f0333a7ec60b9bcacd9921394858de8ced118b5966d1147ba390084dab42326c565a309c29317a6079be30aa1d790d25a517"
    "b43287426cb1d36a",
    {"ca35def5ae56cec33dc2036731ab14896bc4c75dbb07a61f879f8e3afa4c7944b6fe0240b839afac809de1630eaf99d8f9b941394f0512c0"
     "554633bbb021d15176135c0a20e7fdb9a9ed066f22f054b47625b1d5061cb27d6a17f053273db7c25216a5addc506ee321bc0618feb5849d",
     "95ebc60d2b1fa672c1f46a8aa265ef51bfe38e7ccb39ec5be34069f1448088438f627e69fc120006f746b9d420bf4056cf8481ab32d9e904"
     "ffaeeaa56a5290",
     "07fc0034398a5f1010322be193d62f94bebf2948a20b3e15d681fe", "2ea5400f5b8a16971c8b67bde75aeb7987d454b1c0beeb2566932d",
     "96eef918ef51639fc0e156da1823c4f71b33fac5af983f5da9384f7da20d86ed91",
     "f02766a56496e1fbf32e05274baebf6d693c8f3e4c6e0dc7ebdc5ac170f15dae433b92f469"}};

constexpr Vector kNnVector{
    Pattern::nn_psk0,
    "ed5e9692d0ab507b6c2beec3f584fd5b127817a9d20b26cd50aa72c507260fa31aa7d88dd3723316338af37ce0b4cfb2923aeb848bbf2b93"
    "4911306f01ffc963",
    {"ca35def5ae56cec33dc2036731ab14896bc4c75dbb07a61f879f8e3afa4c7944ed63df2f5a12aee1185ee9c50305f2ecf12421dcb53c047a"
     "63b784cf7c54a105",
     "95ebc60d2b1fa672c1f46a8aa265ef51bfe38e7ccb39ec5be34069f1448088430e0fe7d5c0c9b92f7478716c8852f1b4f389edb75e3ebe54"
     "6fafafd5b6f0f7",
     "0fe04b26dcfbb69f8a6a94c61f1a26ef88769218d32f5d17c068a6", "2239e0c540c01f09eb1f4cc5258fd5acfefff18a5a3773f21b7bfe",
     "f216cb03d30fb8af1e561fe02a07552d09b416e27a75e62c77d193718b0bdaae9f",
     "6e8baf98b944184dd7dc5ef14d8108cbeca626de118a5460f3308e294d61e17238bce29bd9"}};

void expect_vector(const Vector& vector) {
  const Bytes prologue = from_hex(kPrologue);
  const SecretKey shared = secret_from_hex(kShared);
  const KeyPair initiator = key_pair_from(key_from_hex(kInitiatorStatic));
  const KeyPair responder = key_pair_from(key_from_hex(kResponderStatic));
  ASSERT_EQ(responder.public_key.bytes, key_from_hex(kResponderPublic));
  Handshake begins({.pattern = vector.pattern,
                    .role = Role::initiator,
                    .prologue = prologue,
                    .own = &initiator,
                    .peer = &responder.public_key,
                    .shared = &shared});
  Handshake answers(
      {.pattern = vector.pattern, .role = Role::responder, .prologue = prologue, .own = &responder, .shared = &shared});
  Handshake* writer = &begins;
  Handshake* reader = &answers;
  for (std::size_t i = 0; i < kHandshakePayloads.size(); ++i) {
    const Bytes payload = from_hex(kHandshakePayloads[i]);
    Bytes message(500);
    Bytes read(500);
    const auto written =
        writer->write(payload, message, key_from_hex(i == 0 ? kInitiatorEphemeral : kResponderEphemeral));
    message.resize(written.bytes);
    EXPECT_THAT(message, ElementsAreArray(from_hex(vector.messages[i])));
    const auto got = reader->read(message, read);
    ASSERT_EQ(got.result, HandshakeResult::done);
    read.resize(got.bytes);
    EXPECT_EQ(read, payload);
    std::swap(writer, reader);
  }
  EXPECT_THAT(begins.hash(), ElementsAreArray(from_hex(vector.hash)));
  EXPECT_EQ(begins.hash(), answers.hash());
  TransportKeys one;
  TransportKeys other;
  begins.split(one);
  answers.split(other);
  EXPECT_EQ(one.send, other.receive);
  EXPECT_EQ(one.receive, other.send);
  for (std::size_t i = 0; i < kLaterPayloads.size(); ++i) {
    const Bytes payload = from_hex(kLaterPayloads[i]);
    const KeyBytes& key = i % 2 == 0 ? one.send : other.send;
    Bytes sealed(payload.size() + kTagBytes);
    ::crypto_aead_chacha20poly1305_ietf_encrypt(raw(sealed), nullptr, raw(payload), payload.size(), nullptr, 0, nullptr,
                                                nonce_of(i / 2).data(), raw(key));
    EXPECT_THAT(sealed, ElementsAreArray(from_hex(vector.messages[2 + i])));
  }
}

TEST(Handshake, OfIKpsk2AgreesWithThePublishedVector) { expect_vector(kIkVector); }

TEST(Handshake, OfNNpsk0AgreesWithThePublishedVector) { expect_vector(kNnVector); }

TEST(Handshake, ShowsTheServerWhoseClientItIs) {
  Ends ends;
  Handshake begins = ends.client_end();
  Handshake answers = ends.server_end();
  const auto hello = begins.write({}, ends.first, key_bytes(4));
  EXPECT_EQ(hello.bytes, Handshake::overhead(Pattern::ik_psk2, 0));
  ASSERT_EQ(answers.read(std::span(ends.first).first(hello.bytes), ends.payload).result, HandshakeResult::done);
  EXPECT_EQ(answers.peer(), ends.client.public_key);
}

TEST(Handshake, RefusesEveryFlippedBitAndThenTakesTheTrueMessage) {
  Ends ends;
  Handshake begins = ends.client_end();
  Handshake answers = ends.server_end();
  const auto expect_only_the_true_one = [&](Handshake& reader, std::span<std::byte> message) {
    for (std::size_t bit = 0; bit < message.size() * 8; ++bit) {
      message[bit / 8] ^= std::byte{1} << bit % 8;
      // The top bit of a public key says nothing (RFC 7748, section 5), but it is authenticated.
      EXPECT_NE(reader.read(message, ends.payload).result, HandshakeResult::done) << "bit " << bit;
      message[bit / 8] ^= std::byte{1} << bit % 8;
    }
    EXPECT_EQ(reader.read(message, ends.payload).result, HandshakeResult::done);
  };
  const Bytes payload(20, std::byte{7});
  expect_only_the_true_one(answers, std::span(ends.first).first(begins.write(payload, ends.first, key_bytes(4)).bytes));
  expect_only_the_true_one(begins,
                           std::span(ends.second).first(answers.write(payload, ends.second, key_bytes(5)).bytes));
}

TEST(Handshake, RefusesAnotherServersKey) {
  Ends ends;
  const KeyPair another = key_pair_from(key_bytes(9));
  Handshake begins = ends.client_end();
  Handshake answers({.pattern = Pattern::ik_psk2, .role = Role::responder, .own = &another, .shared = &ends.shared});
  const auto hello = begins.write({}, ends.first, key_bytes(4));
  EXPECT_EQ(answers.read(std::span(ends.first).first(hello.bytes), ends.payload).result,
            HandshakeResult::not_authentic);
}

TEST(Handshake, RefusesAnotherSharedKey) {
  for (const Pattern pattern : {Pattern::ik_psk2, Pattern::nn_psk0}) {
    Ends ends;
    const SecretKey another = secret_key(9);
    Handshake begins({.pattern = pattern,
                      .role = Role::initiator,
                      .own = &ends.client,
                      .peer = &ends.server.public_key,
                      .shared = &ends.shared});
    Handshake answers({.pattern = pattern, .role = Role::responder, .own = &ends.server, .shared = &another});
    const auto hello = begins.write({}, ends.first, key_bytes(4));
    const auto read = answers.read(std::span(ends.first).first(hello.bytes), ends.payload);
    if (pattern == Pattern::nn_psk0) {
      EXPECT_EQ(read.result, HandshakeResult::not_authentic);
      continue;
    }
    // The pattern mixes the shared key into the answer.
    ASSERT_EQ(read.result, HandshakeResult::done);
    const auto welcome = answers.write({}, ends.second, key_bytes(5));
    EXPECT_EQ(begins.read(std::span(ends.second).first(welcome.bytes), ends.payload).result,
              HandshakeResult::not_authentic);
  }
}

TEST(Handshake, RefusesAnotherPrologue) {
  const SecretKey shared = secret_key(3);
  const Bytes one(3, std::byte{1});
  const Bytes other(3, std::byte{2});
  Handshake begins({.pattern = Pattern::nn_psk0, .role = Role::initiator, .prologue = one, .shared = &shared});
  Handshake answers({.pattern = Pattern::nn_psk0, .role = Role::responder, .prologue = other, .shared = &shared});
  Bytes message(Handshake::overhead(Pattern::nn_psk0, 0));
  Bytes payload;
  ASSERT_EQ(begins.write({}, message, key_bytes(4)).result, HandshakeResult::done);
  EXPECT_EQ(answers.read(message, payload).result, HandshakeResult::not_authentic);
}

TEST(Handshake, RefusesAPublicKeyOfLowOrder) {
  Ends ends;
  Handshake answers = ends.server_end();
  const Bytes zeros(Handshake::overhead(Pattern::ik_psk2, 0));
  EXPECT_EQ(answers.read(zeros, ends.payload).result, HandshakeResult::weak_key);
}

TEST(Handshake, TakesMessagesInTurnAndOfTheRightSizeOnly) {
  Ends ends;
  Handshake begins = ends.client_end();
  Handshake answers = ends.server_end();
  EXPECT_EQ(begins.read(ends.first, ends.payload).result, HandshakeResult::out_of_turn);
  EXPECT_EQ(answers.write({}, ends.first, key_bytes(4)).result, HandshakeResult::out_of_turn);
  EXPECT_EQ(begins.write({}, std::span(ends.first).first(95), key_bytes(4)).result, HandshakeResult::no_room);
  ASSERT_EQ(begins.write({}, std::span(ends.first).first(96), key_bytes(4)).bytes, 96U);
  EXPECT_EQ(begins.write({}, ends.first, key_bytes(4)).result, HandshakeResult::out_of_turn);
  for (std::size_t bytes = 0; bytes < 96; ++bytes) {
    EXPECT_EQ(answers.read(std::span(ends.first).first(bytes), ends.payload).result, HandshakeResult::too_short);
  }
}

TEST(Handshake, SaysWhichKeyIsMissing) {
  const Ends ends;
  EXPECT_THAT([] { const Handshake made({.pattern = Pattern::ik_psk2}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("needs a key pair")));
  EXPECT_THAT([&] { const Handshake made({.pattern = Pattern::ik_psk2, .own = &ends.client}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("needs the other's public key")));
  EXPECT_THAT([] { const Handshake made({.pattern = Pattern::nn_psk0}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("needs a shared key")));
}

TEST(Handshake, DoesNotAllocateAfterItIsMade) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Ends ends;
  Handshake begins = ends.client_end();
  Handshake answers = ends.server_end();
  TransportKeys keys;
  const test::AllocationGuard guard;
  const auto hello = begins.write({}, ends.first, key_bytes(4));
  const auto read = answers.read(std::span(ends.first).first(hello.bytes), ends.payload);
  const auto welcome = answers.write({}, ends.second, key_bytes(5));
  const auto answered = begins.read(std::span(ends.second).first(welcome.bytes), ends.payload);
  begins.split(keys);
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_EQ(read.result, HandshakeResult::done);
  EXPECT_EQ(answered.result, HandshakeResult::done);
}

}  // namespace
}  // namespace forcebound::security

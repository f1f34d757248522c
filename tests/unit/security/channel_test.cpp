#include "forcebound/security/channel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "tests/support/allocation_guard.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::security {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

using Record = std::vector<std::byte>;

/// A client and a server that have finished handshakes.
class Channels : public testing::Test {
 protected:
  Channels() { shake_hands(1); }

  void shake_hands(std::uint8_t number) {
    const auto keys = ends_.keys(number);
    ASSERT_TRUE(server_.install(number, keys[1], Role::responder, now_));
    ASSERT_TRUE(client_.install(number, keys[0], Role::initiator, now_));
  }

  Record sealed_by(Channel& channel) {
    Record record(plain_.size() + kRecordOverhead);
    EXPECT_EQ(channel.seal(plain_, record, now_), record.size());
    return record;
  }

  Opening opening_by(Channel& channel, std::span<const std::byte> record) {
    Record opened(plain_.size());
    const Opened result = channel.open(record, opened, now_);
    if (result.result == Opening::opened) {
      EXPECT_EQ(opened, plain_);
      EXPECT_EQ(result.bytes, plain_.size());
    }
    return result.result;
  }

  Opening from_client() { return opening_by(server_, sealed_by(client_)); }
  Opening from_server() { return opening_by(client_, sealed_by(server_)); }

  Ends ends_;
  time::Nanoseconds now_{seconds(1000)};
  Channel client_{SessionNumbers{.own = 11, .peer = 22}};
  Channel server_{SessionNumbers{.own = 22, .peer = 11}};
  Record plain_ = Record(77, std::byte{0x42});
};

TEST_F(Channels, OpenWhatTheOtherSealed) {
  EXPECT_FALSE(server_.can_seal(now_)) << "nothing has shown yet that the client has the key";
  EXPECT_EQ(from_client(), Opening::opened);
  EXPECT_EQ(from_server(), Opening::opened);
  plain_.clear();
  EXPECT_EQ(from_client(), Opening::opened) << "an empty record";
}

TEST_F(Channels, ShowNothingOfWhatIsSealed) {
  const Record record = sealed_by(client_);
  EXPECT_EQ(std::search(record.begin(), record.end(), plain_.begin(), plain_.begin() + 4), record.end());
  EXPECT_EQ(session_of_record(record), 22U);
}

TEST_F(Channels, RefuseEveryFlippedBit) {
  Record record = sealed_by(client_);
  for (std::size_t bit = 0; bit < record.size() * 8; ++bit) {
    record[bit / 8] ^= std::byte{1} << bit % 8;
    const Opening expected = bit < 24   ? Opening::malformed
                             : bit < 32 ? Opening::unknown_key
                             : bit < 64 ? Opening::other_session
                                        : Opening::not_authentic;
    EXPECT_EQ(opening_by(server_, record), expected) << "bit " << bit;
    record[bit / 8] ^= std::byte{1} << bit % 8;
  }
  EXPECT_EQ(opening_by(server_, record), Opening::opened);
}

TEST_F(Channels, RefuseEveryShortenedRecord) {
  const Record record = sealed_by(client_);
  for (std::size_t bytes = 0; bytes < record.size(); ++bytes) {
    EXPECT_EQ(opening_by(server_, std::span(record).first(bytes)),
              bytes < kRecordOverhead ? Opening::malformed : Opening::not_authentic);
  }
}

TEST_F(Channels, RefuseASecondCopy) {
  const Record record = sealed_by(client_);
  EXPECT_EQ(opening_by(server_, record), Opening::opened);
  EXPECT_EQ(opening_by(server_, record), Opening::replayed);
}

TEST_F(Channels, OpenRecordsInAnyOrder) {
  std::vector<Record> records;
  records.reserve(5000);
  for (int i = 0; i < 5000; ++i) records.push_back(sealed_by(client_));
  for (auto record = records.rbegin(); record != records.rend(); ++record) {
    ASSERT_EQ(opening_by(server_, *record), Opening::opened);
  }
  for (const Record& record : records) ASSERT_EQ(opening_by(server_, record), Opening::replayed);
}

TEST_F(Channels, AreNotMovedByAForgedCounterFarAhead) {
  Record forged = sealed_by(client_);
  const Record before = sealed_by(client_);
  forged[kRecordHeaderBytes - 1] = std::byte{0x7f};
  EXPECT_EQ(opening_by(server_, forged), Opening::not_authentic);
  EXPECT_EQ(opening_by(server_, before), Opening::opened);
}

TEST_F(Channels, RefuseRecordsOfAnotherHandshakeWithTheSameNumber) {
  Channel other({.own = 11, .peer = 22});
  const auto keys = ends_.keys(50);
  ASSERT_TRUE(other.install(1, keys[0], Role::initiator, now_));
  EXPECT_EQ(opening_by(server_, sealed_by(other)), Opening::not_authentic);
}

TEST_F(Channels, RefuseTheirOwnRecordsSentBack) {
  Channel reflected({.own = 22, .peer = 11});
  const auto keys = ends_.keys(1);
  ASSERT_TRUE(reflected.install(1, keys[0], Role::initiator, now_));
  EXPECT_EQ(opening_by(client_, sealed_by(reflected)), Opening::not_authentic);
}

TEST_F(Channels, ChangeKeysWithoutAGap) {
  EXPECT_EQ(from_client(), Opening::opened);
  const Record old_of_client = sealed_by(client_);
  const Record old_of_server = sealed_by(server_);
  now_ += minutes(2);
  EXPECT_TRUE(client_.wants_rekey(now_));
  const auto keys = ends_.keys(2);
  ASSERT_TRUE(server_.install(2, keys[1], Role::responder, now_));
  EXPECT_EQ(from_server(), Opening::opened) << "before the client has the answer";
  EXPECT_EQ(from_client(), Opening::opened);
  ASSERT_TRUE(client_.install(2, keys[0], Role::initiator, now_));
  EXPECT_FALSE(client_.wants_rekey(now_));
  EXPECT_EQ(from_server(), Opening::opened) << "before the server knows that the client has the key";
  EXPECT_EQ(server_.handshake(), 1);
  EXPECT_EQ(from_client(), Opening::opened);
  EXPECT_EQ(server_.handshake(), 2);
  EXPECT_EQ(from_server(), Opening::opened);
  EXPECT_EQ(opening_by(server_, old_of_client), Opening::opened) << "it was overtaken";
  EXPECT_EQ(opening_by(client_, old_of_server), Opening::opened) << "it was overtaken";
}

TEST_F(Channels, ForgetTheKeyBeforeSomeTimeAfterTheNewOneIsConfirmed) {
  EXPECT_EQ(from_client(), Opening::opened);
  const Record old = sealed_by(client_);
  now_ += minutes(2);
  shake_hands(2);
  EXPECT_EQ(from_client(), Opening::opened);
  now_ += kOldKeyKept;
  EXPECT_EQ(opening_by(server_, old), Opening::expired);
  (void)sealed_by(server_);
  EXPECT_EQ(opening_by(server_, old), Opening::unknown_key);
  EXPECT_EQ(from_client(), Opening::opened);
}

TEST_F(Channels, KeepTheOldKeyWhereTheNewOneIsNeverConfirmed) {
  EXPECT_EQ(from_client(), Opening::opened);
  now_ += minutes(2);
  const auto lost = ends_.keys(2);
  const auto next = ends_.keys(60);
  ASSERT_TRUE(server_.install(2, lost[1], Role::responder, now_));
  ASSERT_TRUE(server_.install(2, next[1], Role::responder, now_)) << "the client asks again";
  EXPECT_EQ(from_client(), Opening::opened);
  EXPECT_EQ(from_server(), Opening::opened);
  ASSERT_TRUE(client_.install(2, next[0], Role::initiator, now_));
  EXPECT_EQ(from_client(), Opening::opened);
  EXPECT_EQ(server_.handshake(), 2);
}

TEST_F(Channels, ForgetEveryKeyWhereAnotherSessionBegins) {
  std::vector<Record> records{sealed_by(client_)};
  EXPECT_EQ(from_client(), Opening::opened);
  shake_hands(2);
  records.push_back(sealed_by(client_));
  EXPECT_EQ(from_client(), Opening::opened) << "the first key is the previous one, the second the current one";
  shake_hands(3);
  records.push_back(sealed_by(client_));
  server_.begin({.own = 22, .peer = 11});
  EXPECT_FALSE(server_.can_seal(now_));
  for (const Record& record : records) EXPECT_EQ(opening_by(server_, record), Opening::unknown_key);
}

TEST_F(Channels, RefuseTheNumberOfAKeyInUse) {
  EXPECT_EQ(from_client(), Opening::opened);
  const auto keys = ends_.keys(7);
  EXPECT_FALSE(server_.install(1, keys[1], Role::responder, now_));
  EXPECT_FALSE(client_.install(1, keys[0], Role::initiator, now_));
  EXPECT_EQ(from_client(), Opening::opened);
}

TEST_F(Channels, EndWhenNoHandshakeRenewsTheKey) {
  EXPECT_EQ(from_client(), Opening::opened);
  const Record late = sealed_by(client_);
  now_ += kKeyExpiresAfter;
  Record record(plain_.size() + kRecordOverhead);
  EXPECT_FALSE(client_.can_seal(now_));
  EXPECT_EQ(client_.seal(plain_, record, now_), std::nullopt);
  EXPECT_EQ(opening_by(server_, late), Opening::expired);
}

TEST_F(Channels, NeedRoom) {
  Record record(plain_.size() + kRecordOverhead - 1);
  EXPECT_EQ(client_.seal(plain_, record, now_), std::nullopt);
  Record small(plain_.size() - 1);
  EXPECT_EQ(server_.open(sealed_by(client_), small, now_).result, Opening::no_room);
}

TEST_F(Channels, DoNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Record record(plain_.size() + kRecordOverhead);
  Record opened(plain_.size());
  const test::AllocationGuard guard;
  const auto sealed = client_.seal(plain_, record, now_);
  const auto result = server_.open(record, opened, now_);
  const auto again = server_.open(record, opened, now_);
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_EQ(sealed, record.size());
  EXPECT_EQ(result.result, Opening::opened);
  EXPECT_EQ(again.result, Opening::replayed);
}

}  // namespace
}  // namespace forcebound::security

#include "forcebound/server/runtime/worker_mail.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <new>

#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/runtime/udp_server.hpp"

namespace forcebound::server {
namespace {

using Put = WorkerMail::Put;
using Stage = WorkerMail::Stage;

/// A sealed datagram, of which nothing is right but its receiver's number.
std::array<std::byte, 64> record_of(std::uint8_t keys) {
  std::array<std::byte, 64> record{std::byte{'F'}, std::byte{'S'}, std::byte{1}};
  record[4] = std::byte{keys};
  return record;
}

TEST(WorkerMail, WakesForTheFirstAloneAndGivesTheOldest) {
  WorkerMail mail;
  EXPECT_TRUE(mail.empty());
  const std::array first{std::byte{1}};
  const std::array second{std::byte{2}};
  EXPECT_EQ(mail.put({.bytes = first, .stage = Stage::hello_judged}), Put::was_empty);
  EXPECT_EQ(mail.put({.bytes = second, .from = {.port = 9}}), Put::taken);
  WorkerMail::Handed handed;
  ASSERT_TRUE(mail.take(handed));
  EXPECT_EQ(handed.bytes[0], std::byte{1});
  EXPECT_EQ(handed.stage, Stage::hello_judged);
  ASSERT_TRUE(mail.take(handed));
  EXPECT_EQ(handed.bytes[0], std::byte{2});
  EXPECT_EQ(handed.stage, Stage::as_it_came);
  EXPECT_EQ(handed.from.port, 9);
  EXPECT_FALSE(mail.take(handed));
  EXPECT_TRUE(mail.empty());
  EXPECT_EQ(mail.put({.bytes = first}), Put::was_empty);
}

TEST(WorkerMail, HasRoomForFewOfEachSessionOfKeysAndForHellosWhateverComes) {
  WorkerMail mail;
  std::size_t taken = 0;
  for (int i = 0; i < 1000; ++i) taken += mail.put({.bytes = record_of(7)}) != Put::no_room ? 1 : 0;
  EXPECT_EQ(taken, WorkerMail::kOfKeysMost);
  EXPECT_NE(mail.put({.bytes = record_of(8)}), Put::no_room) << "of others there may be as many";
  for (int i = 0; i < 1000; ++i) {
    taken += mail.put({.bytes = record_of(static_cast<std::uint8_t>(i % 250)), .worker = 1}) != Put::no_room ? 1 : 0;
  }
  EXPECT_LE(taken, WorkerMail::kOfKeysMost + WorkerMail::kOfWorkerMost) << "nor does one worker take all";
  EXPECT_NE(mail.put({.bytes = record_of(251), .worker = 2}), Put::no_room);
  for (std::size_t worker = 2; worker < 9; ++worker) {
    for (int i = 0; i < 250; ++i) (void)mail.put({.bytes = record_of(static_cast<std::uint8_t>(i)), .worker = worker});
  }
  EXPECT_EQ(mail.put({.bytes = record_of(252), .worker = 9}), Put::no_room);
  std::size_t hellos = 0;
  while (mail.put({.bytes = record_of(1), .stage = Stage::hello_judged}) != Put::no_room) ++hellos;
  EXPECT_EQ(hellos, WorkerMail::kDatagramsMost - WorkerMail::kAsTheyCameMost);
}

TEST(WorkerMail, KeepsWorkThatFoundNoMemoryAndDoesItAgain) {
  EnvironmentLibrary environments(SceneLibrary::shipped());
  UdpServer server(listen({"127.0.0.1", 0}), {.scene = "wall"}, environments);
  WorkerMail mail;
  int tries = 0;
  bool second = false;
  mail.post_work([&](UdpServer&) {
    if (++tries == 1) throw std::bad_alloc();
  });
  mail.post_work([&](UdpServer&) { second = true; });
  EXPECT_FALSE(mail.work_done());
  EXPECT_TRUE(mail.empty()) << "a worker without memory for its work sleeps between its tries";
  mail.do_work(server);
  EXPECT_FALSE(mail.work_done());
  EXPECT_FALSE(second) << "in order";
  mail.do_work(server);
  EXPECT_TRUE(mail.work_done());
  EXPECT_TRUE(second);
  EXPECT_EQ(tries, 2);
}

}  // namespace
}  // namespace forcebound::server

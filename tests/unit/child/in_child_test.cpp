#include "forcebound/child/in_child.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>
#include <new>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/tools/temporary_folder.hpp"

namespace forcebound::child {
namespace {

using testing::ThrowsMessage;
using namespace std::chrono_literals;

TEST(InChild, GivesTheAnswer) {
  EXPECT_EQ(in_child([] { return std::string("one\0two", 7); }), std::string("one\0two", 7));
  EXPECT_EQ(in_child([] { return std::string(); }), "");
  const std::string large(std::size_t{5} << 20U, 'x');
  EXPECT_EQ(in_child([&] { return large; }), large);
}

TEST(InChild, ChangesNothingHere) {
  int here = 0;
  EXPECT_EQ(in_child([&] { return std::to_string(++here); }), "1");
  EXPECT_EQ(here, 0);
}

TEST(InChild, PassesOnItsError) {
  EXPECT_THAT([] { (void)in_child([]() -> std::string { throw std::invalid_argument("line 7: no such body"); }); },
              ThrowsMessage<std::runtime_error>("line 7: no such body"));
  EXPECT_THAT([] { (void)in_child([]() -> std::string { throw 1; }); }, ThrowsMessage<std::runtime_error>("fails"));
  EXPECT_THAT([] { (void)in_child([]() -> std::string { throw std::bad_alloc(); }); },
              ThrowsMessage<std::runtime_error>("needs more than 1024 MiB of memory: expected less"));
}

TEST(InChild, OutlivesItsCrash) {
  for (const int number : {SIGSEGV, SIGABRT, SIGKILL}) {
    EXPECT_THAT(
        [&] { (void)in_child([&]() -> std::string { return ::raise(number) == 0 ? "" : "no signal"; }); },
        ThrowsMessage<std::runtime_error>(std::string("ends the process that does it: ") + ::strsignal(number)));
  }
  EXPECT_THAT([] { (void)in_child([]() -> std::string { ::_exit(0); }); },
              ThrowsMessage<std::runtime_error>("ends the process that does it: no answer"));
}

TEST(InChild, EndsWhatTakesTooLong) {
  EXPECT_THAT(
      [] {
        (void)in_child(
            []() -> std::string {
              while (true) ::pause();
            },
            {.time = 200ms});
      },
      ThrowsMessage<std::runtime_error>("takes longer than 0.2 s: expected less"));
}

TEST(InChild, LimitsItsAnswer) {
  EXPECT_THAT([] { (void)in_child([] { return std::string(2'000'000, 'x'); }, {.answer_bytes = 1'000'000}); },
              ThrowsMessage<std::runtime_error>("gives more than 1000000 bytes: expected less"));
}

TEST(InChild, LimitsItsMemory) {
  if (!kLimitsMemoryOfChildren) GTEST_SKIP() << "a sanitizer has terabytes of its own";
  const auto takes = [](std::size_t bytes) {
    return in_child([=] { return std::string(bytes, 'x'); }, {.memory_bytes = std::size_t{64} << 20U}).size();
  };
  EXPECT_EQ(takes(1'000'000), 1'000'000U);
  EXPECT_THAT([&] { (void)takes(std::size_t{200} << 20U); },
              ThrowsMessage<std::runtime_error>("needs more than 64 MiB of memory: expected less"));
}

TEST(InChild, OpensAndWritesNoFile) {
  const test::TemporaryFolder folder;
  const std::string file = folder.file("text");
  std::ofstream(file) << "secret";
  const auto opened = [&] { return std::string(std::ifstream(file) ? "yes" : "no"); };
  EXPECT_EQ(opened(), "yes");
  EXPECT_EQ(in_child(opened), "no");
  EXPECT_EQ(in_child([&] { return std::string(std::ofstream(folder.file("new")) ? "yes" : "no"); }), "no");
}

TEST(InChild, RunsOnSeveralThreadsAtOnce) {
  std::vector<std::string> answers(4);
  {
    std::vector<std::jthread> threads;
    threads.reserve(answers.size());
    for (std::string& answer : answers) threads.emplace_back([&answer] { answer = in_child([] { return "done"; }); });
  }
  EXPECT_THAT(answers, testing::Each("done"));
}

}  // namespace
}  // namespace forcebound::child

#include "forcebound/server/app/notice_after.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <future>

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;

TEST(NoticeAfter, IsGivenWhileTheWorkGoesOn) {
  std::promise<void> told;
  const NoticeAfter notice(1ms, [&] { told.set_value(); });
  told.get_future().wait();
}

TEST(NoticeAfter, IsNotGivenAboutWorkThatEndedBefore) {
  bool told = false;
  {
    const NoticeAfter notice(24h, [&] { told = true; });
  }
  EXPECT_FALSE(told);
}

}  // namespace
}  // namespace forcebound::server

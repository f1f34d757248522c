#include "forcebound/server/app/notice_after.hpp"

#include <stop_token>
#include <utility>

namespace forcebound::server {

NoticeAfter::NoticeAfter(time::Nanoseconds after, std::function<void()> tell)
    : waiting_([this, after, tell = std::move(tell)](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        ended_.wait_for(lock, stop, after, [] { return false; });
        if (!stop.stop_requested()) tell();
      }) {}

}  // namespace forcebound::server

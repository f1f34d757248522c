#include "forcebound/server/app/notice_after.hpp"

#include <stop_token>
#include <utility>

namespace forcebound::server {

NoticeAfter::NoticeAfter(time::Nanoseconds after, std::function<void()> report)
    : waiting_([this, after, report = std::move(report)](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        ended_.wait_for(lock, stop, after, [] { return false; });
        if (!stop.stop_requested()) report();
      }) {}

}  // namespace forcebound::server

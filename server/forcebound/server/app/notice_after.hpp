#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "forcebound/time/clock.hpp"

namespace forcebound::server {

/// Tells what takes long: calls a function once, on a thread of its own, if this object still exists after a while.
class NoticeAfter {
 public:
  NoticeAfter(time::Nanoseconds after, std::function<void()> report);

 private:
  std::mutex mutex_;
  std::condition_variable_any ended_;
  std::jthread waiting_;  // the last, so that it ends before what it uses
};

}  // namespace forcebound::server

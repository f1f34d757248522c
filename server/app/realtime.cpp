#include "forcebound/server/app/realtime.hpp"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace forcebound::server {
namespace {

constexpr int kPriority = 40;

std::string outcome(const char* what, int result) {
  if (result == 0) return std::string(what) + " granted";
  return std::string(what) + " refused (" + std::strerror(errno) + ")";
}

}  // namespace

std::string ask_for_realtime() {
  sched_param parameters{};
  parameters.sched_priority = kPriority;
  const std::string scheduling = outcome("real-time scheduling", sched_setscheduler(0, SCHED_FIFO, &parameters));
  return scheduling + ", " + outcome("locked memory", mlockall(MCL_CURRENT | MCL_FUTURE));
}

}  // namespace forcebound::server

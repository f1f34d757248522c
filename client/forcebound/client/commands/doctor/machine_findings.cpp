#include "forcebound/client/commands/doctor/machine_findings.hpp"

#include <sys/resource.h>
#include <unistd.h>

namespace forcebound::client::commands {
namespace {

std::uint64_t resource_limit(__rlimit_resource resource) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) return 0;
  return limit.rlim_cur == RLIM_INFINITY ? kUnlimited : std::uint64_t{limit.rlim_cur};
}

}  // namespace

MachineFindings machine_findings() {
  MachineFindings found;
  found.sleep_states = read_sleep_states("/sys/devices/system/cpu");
  found.can_keep_awake = access("/dev/cpu_dma_latency", W_OK) == 0;
  found.priority_limit = resource_limit(RLIMIT_RTPRIO);
  found.memory_limit = resource_limit(RLIMIT_MEMLOCK);
  return found;
}

}  // namespace forcebound::client::commands

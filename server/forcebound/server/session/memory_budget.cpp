#include "forcebound/server/session/memory_budget.hpp"

#include <algorithm>

#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

/// Rounded up, so that what is too much does not look like what is allowed.
std::string in_mb(std::size_t bytes) {
  constexpr std::size_t kMegabyte = std::size_t{1} << 20U;
  return std::to_string(bytes / kMegabyte + (bytes % kMegabyte > 0 ? 1 : 0)) + " MiB";
}

}  // namespace

MemoryBudget::Refusal MemoryBudget::refusal_of(const std::string& scene) const {
  const auto known = takes_.find(scene);
  if (known == takes_.end() || !limits_.in_use) return {};
  return decide(scene, known->second, limits_.in_use() + known->second);
}

MemoryBudget::Refusal MemoryBudget::refusal_of_made(const std::string& scene, std::size_t before) {
  if (!limits_.in_use) return {};
  const std::size_t now = limits_.in_use();
  const std::size_t takes = std::max(now, before) - before;
  takes_[scene] = takes;
  return decide(scene, takes, now);
}

MemoryBudget::Refusal MemoryBudget::decide(const std::string& scene, std::size_t takes, std::size_t with_it) const {
  if (takes > limits_.session_most) {
    return {.for_now = false,
            .text = "a session in scene '" + text::printable(scene) + "' takes " + in_mb(takes) + " of memory, of " +
                    in_mb(limits_.session_most) + " that this server allows"};
  }
  if (limits_.all_most > 0 && with_it > limits_.all_most) {
    return {.for_now = true,
            .text = "this server's memory is used up: with another session in scene '" + text::printable(scene) +
                    "' it would have " + in_mb(with_it) + ", of " + in_mb(limits_.all_most) +
                    " at most; try again later"};
  }
  return {};
}

}  // namespace forcebound::server

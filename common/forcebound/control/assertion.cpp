#include "forcebound/control/assertion.hpp"

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace forcebound::control {
namespace {

std::atomic<LastResort*> last_resort{nullptr};
std::atomic<bool> ending{false};

}  // namespace

LastResortScope::LastResortScope(LastResort& resort) noexcept : before_(last_resort.exchange(&resort)) {}
LastResortScope::~LastResortScope() { last_resort = before_; }

void end_by_assertion(const FailedAssertion& failed) noexcept {
  // Only once: zero force may meet the same bug.
  LastResort* const resort = ending.exchange(true) ? nullptr : last_resort.load();
  if (resort != nullptr) resort->make_safe();
  std::array<char, 512> words{};
  const std::size_t length = resort != nullptr ? resort->describe(words) : 0;
  std::fprintf(stderr, "%s:%d: a bug of Forcebound: '%s' is false (%s)%s%.*s\n", failed.file, failed.line,
               failed.condition, failed.what, length > 0 ? "; " : "", static_cast<int>(length), words.data());
  std::abort();
}

}  // namespace forcebound::control

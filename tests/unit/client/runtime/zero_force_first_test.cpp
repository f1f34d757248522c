#include "forcebound/client/runtime/zero_force_first.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string_view>

#include "forcebound/control/law_registry.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/fake_device.hpp"
#include "tests/support/fake_link.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

/// Prints the commands on stderr, since the program under test dies.
class TellingDevice final : public device::HapticDevice {
 public:
  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return still_.facts(); }
  device::Reading read(Nanoseconds now) noexcept override { return still_.read(now); }
  void apply(Nanoseconds now, const Vector& force_N) noexcept override {
    still_.apply(now, force_N);
    std::fprintf(stderr, "%g N, ", force_N[0]);
  }
  [[nodiscard]] std::optional<Nanoseconds> released_at() const noexcept override { return std::nullopt; }

 private:
  test::FakeDevice still_{1};
};

/// Fails an assertion on the second tick.
class PoisonedLaw final : public control::PassivityLaw {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "poisoned"; }
  void credit(const control::Motion&) noexcept override { FORCEBOUND_ASSERT(ticks_++ == 0, "this law has no bug"); }
  void lose(const control::Motion&) noexcept override {}
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override { return request_N; }
  [[nodiscard]] bool allows(const Vector&, double) const noexcept override { return true; }
  void commit(const Vector&) noexcept override {}
  [[nodiscard]] double energy_J() const noexcept override { return 0; }

 private:
  int ticks_ = 0;
};

struct Loop {
  TellingDevice device;
  test::FakeLink link;
  test::FakeClock clock;
  Session session{
      {.server = {.ip = {1}, .port = 1}, .seed = 7}, device, std::make_unique<PoisonedLaw>(), link, clock, {}};
};

TEST(ZeroForceFirstDeathTest, StopsTheDeviceBeforeItTellsOfTheBug) {
  Loop loop;
  loop.session.tick(loop.clock.time);
  ZeroForceFirst zero_force_first(loop.device, loop.session, loop.clock, 7);
  const control::LastResortScope scope(zero_force_first);
  loop.clock.time += 1ms;
  EXPECT_DEATH(loop.session.tick(loop.clock.time),
               "^0 N, .*a bug of Forcebound: .*this law has no bug.*; tick 1, state connecting, seed 7");
}

TEST(ZeroForceFirst, DescribesOnlyWhatThereIsRoomFor) {
  Loop loop;
  const ZeroForceFirst zero_force_first(loop.device, loop.session, loop.clock, 7);
  std::array<char, 8> few{};
  EXPECT_EQ(zero_force_first.describe(few), 7U);
  EXPECT_EQ(std::string_view(few.data()), "tick 0,");
}

}  // namespace
}  // namespace forcebound::client

#include "forcebound/client/commands/check_device/guided_checks.hpp"

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "forcebound/text/numbers.hpp"

namespace forcebound::client::commands {
namespace {

constexpr double kPatience_s = 60;
constexpr int kInARow = 20;           // a reading or two may fail without anything being wrong
constexpr int kCommandsOffered = 50;  // while it is unplugged
constexpr int kTicksAtRest = 500;
constexpr double kRest_m_max = 0.002;
constexpr double kFelt_m = 1e-4;

/// The checks in their order; each needs what those before it found.
class GuidedChecks {
 public:
  GuidedChecks(DeviceDriving& driving, Person& person, double force_N,
               const std::function<void(const DeviceCheck&)>& found)
      : driving_(driving), person_(person), force_N_(force_N), found_(found) {}

  void run() {
    if (unplug() && plug_in() && has_no_force()) has_force_again();
    press_buttons();
  }

 private:
  void add(const char* name, bool holds, std::string measured, std::string accepted) {
    found_({name, holds ? Verdict::passed : Verdict::failed, std::move(measured), std::move(accepted)});
  }

  /// Calls `tick` until `done` is true, asking the person for `what`. @returns false: the time is over
  template <class What, class Tick, class Done>
  bool ask_until(What what, Tick tick, Done done) {
    const Nanoseconds end = driving_.now() + time::from_seconds(kPatience_s);
    while (driving_.now() < end) {
      person_.ask(what(), time::to_seconds(end - driving_.now()));
      tick();
      if (done()) return true;
    }
    return false;
  }

  /// Whether so many readings in a row were of a kind, told by its count.
  class InARow {
   public:
    [[nodiscard]] bool reached(std::uint64_t count, std::uint64_t others) {
      if (others != others_) from_ = count;
      others_ = others;
      return count >= from_ + kInARow;
    }

   private:
    std::uint64_t from_ = 0;
    std::uint64_t others_ = 0;
  };

  bool unplug() {
    driving_.begin("unplugging");
    driving_.forget_readings();
    InARow failed;
    const bool gone = ask_until([] { return "Unplug the device."; }, [this] { driving_.tick(driving_.zero()); },
                                [&] { return failed.reached(driving_.readings().failed(), driving_.readings().good); });
    add("unplugging", gone,
        gone ? "readings fail: " + driving_.readings().last_failure
             : "no reading failed within " + text::rounded(kPatience_s) + " s",
        "readings fail while it is unplugged");
    return gone;
  }

  bool plug_in() {
    driving_.begin("plugging in");
    driving_.forget_readings();
    InARow good;
    int offered = 0;
    const bool back = ask_until([] { return "Plug the device in again, and let nobody hold it."; },
                                [&] {
                                  if (++offered > kCommandsOffered) return driving_.tick(std::nullopt);
                                  driving_.tick_while_unreadable(force_N_ * Vector::Unit(driving_.zero().size(), 0));
                                },
                                [&] { return good.reached(driving_.readings().good, driving_.readings().failed()); });
    add("plugging in", back,
        back ? "readings succeed again" : "no readings within " + text::rounded(kPatience_s) + " s",
        "readings succeed again, without another start");
    return back;
  }

  bool has_no_force() {
    constexpr const char* kName = "force when plugged in";
    driving_.begin(kName);
    const Vector from = driving_.position();
    double moved_m = 0;
    for (int tick = 0; tick < kTicksAtRest && moved_m <= kRest_m_max; ++tick) {
      driving_.tick(std::nullopt);
      moved_m = (driving_.position() - from).norm();
    }
    const bool rests = moved_m <= kRest_m_max;
    if (!rests) driving_.stop();
    add(kName, rests, "moved " + text::rounded(1e3 * moved_m) + " mm without a command",
        "at most " + text::rounded(1e3 * kRest_m_max) + " mm: no force before the first command");
    return rests;
  }

  void has_force_again() {
    constexpr const char* kName = "force after that";
    driving_.begin(kName);
    const Push push = driving_.push({.along = Vector::Unit(driving_.zero().size(), 0), .force_N = force_N_});
    if (!push.too_fast.empty()) throw TooFast(push.too_fast);
    add(kName, push.moved[0] >= kFelt_m, "moved " + text::rounded(1e3 * push.moved[0]) + " mm along +x",
        "> 0.1 mm, once it is commanded");
    driving_.begin("braking after that");
    driving_.brake(force_N_);
  }

  void press_buttons() {
    driving_.begin("buttons");
    driving_.tick(driving_.zero());
    if (!driving_.buttons()) {
      found_({"buttons", Verdict::not_checked, "its readings have none", ""});
      return;
    }
    std::uint32_t pressed = 0;
    std::uint32_t released = 0;
    const auto note = [&] {
      const std::uint32_t now = driving_.buttons().value_or(0);
      released |= pressed & ~now;
      pressed |= now;
      return person_.is_done();
    };
    const auto ask = [&] {
      std::string what = "Press and release each button, then press Enter.";
      if (released != 0) what += " Released: " + numbers_of(released) + ".";
      if (pressed != released) what += " Pressed: " + numbers_of(pressed & ~released) + ".";
      return what;
    };
    (void)ask_until(
        ask, [this] { driving_.tick(driving_.zero()); }, note);
    const bool holds = pressed != 0 && released == pressed;
    std::string measured = pressed == 0 ? "none was pressed" : "pressed: " + numbers_of(pressed);
    if (released != pressed) measured += "; not released: " + numbers_of(pressed & ~released);
    add("buttons", holds, measured, "each that was pressed, by its number from 0, and then released");
  }

  static std::string numbers_of(std::uint32_t buttons) {
    std::string numbers;
    for (; buttons != 0; buttons &= buttons - 1) {
      numbers += (numbers.empty() ? "" : ", ") + std::to_string(std::countr_zero(buttons));
    }
    return numbers;
  }

  DeviceDriving& driving_;
  Person& person_;
  double force_N_;
  const std::function<void(const DeviceCheck&)>& found_;
};

}  // namespace

void check_with_a_person(DeviceDriving& driving, Person& person, double force_N,
                         const std::function<void(const DeviceCheck&)>& found) {
  GuidedChecks(driving, person, force_N, found).run();
}

}  // namespace forcebound::client::commands

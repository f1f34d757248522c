// Only where there is libevdev; of its own functions on devices that are made up, and of others in place of the kernel.
#ifdef FORCEBOUND_LIBEVDEV
#include "client/drivers/evdev_events.h"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <initializer_list>
#include <memory>

namespace forcebound::driver {
namespace {

using Events = std::unique_ptr<libevdev, decltype(&libevdev_free)>;

Events device_with(unsigned type, std::initializer_list<unsigned> codes) {
  Events events(libevdev_new(), &libevdev_free);
  for (const unsigned code : codes) libevdev_enable_event_code(events.get(), type, code, nullptr);
  return events;
}

evdev_state begun(const libevdev* events) {
  evdev_state state{};
  state.scale = {.count_m = 1e-4, .wheel_m = 5e-3, .width_m = 0.2, .follow_s = 0, .upright = 0};
  evdev_begin(&state, events);
  return state;
}

TEST(EvdevBegin, KnowsTheButtonsThatAreHeld) {
  const Events mouse = device_with(EV_REL, {REL_X, REL_Y});
  for (const unsigned button : {BTN_LEFT, BTN_RIGHT, BTN_MIDDLE}) {
    libevdev_enable_event_code(mouse.get(), EV_KEY, button, nullptr);
  }
  EXPECT_EQ(begun(mouse.get()).buttons, 0U);
  libevdev_set_event_value(mouse.get(), EV_KEY, BTN_RIGHT, 1);
  EXPECT_EQ(begun(mouse.get()).buttons, 2U);
}

TEST(EvdevBegin, TellsTheCapOfA3DMouseFromAMouse) {
  const Events cap = device_with(EV_REL, {REL_X, REL_Y, REL_Z, REL_RX, REL_RY, REL_RZ});
  EXPECT_EQ(begun(cap.get()).deflects, 1);
  const Events mouse = device_with(EV_REL, {REL_X, REL_Y, REL_WHEEL});
  EXPECT_EQ(begun(mouse.get()).deflects, 0);
  const Events tablet = device_with(EV_KEY, {BTN_TOUCH});
  EXPECT_EQ(begun(tablet.get()).deflects, 0);
  EXPECT_EQ(begun(tablet.get()).absolute, 1);
}

/// What the kernel and libevdev would tell, call by call.
struct Told {
  int result;
  input_event event;
};
std::deque<Told> the_events;     // NOLINT: evdev_take knows no context but libevdev's
std::deque<unsigned> the_flags;  // NOLINT: likewise

int next(libevdev* /*events*/, unsigned flags, input_event* event) {
  the_flags.push_back(flags);
  if (the_events.empty()) return -EAGAIN;
  const Told told = the_events.front();
  the_events.pop_front();
  *event = told.event;
  return told.result;
}

input_event event_of(unsigned type, unsigned code, int value) {
  input_event event{};
  event.type = static_cast<decltype(event.type)>(type);
  event.code = static_cast<decltype(event.code)>(code);
  event.value = value;
  return event;
}

TEST(EvdevTake, TakesAllThatIsToldAnewAfterEventsWereDropped) {
  const Events mouse = device_with(EV_REL, {REL_X, REL_Y});
  evdev_state state = begun(mouse.get());
  the_flags.clear();
  the_events = {{LIBEVDEV_READ_STATUS_SYNC, event_of(EV_SYN, SYN_DROPPED, 0)}};
  constexpr int kToldAnew = 2 * EVDEV_EVENTS_MOST;
  for (int i = 0; i < kToldAnew; ++i) {
    the_events.push_back({LIBEVDEV_READ_STATUS_SYNC, event_of(EV_KEY, KEY_A, i % 2)});
  }
  the_events.push_back({LIBEVDEV_READ_STATUS_SYNC, event_of(EV_KEY, BTN_LEFT, 1)});
  the_events.push_back({-EAGAIN, {}});
  EXPECT_EQ(evdev_take(&state, next, mouse.get()), 1);
  EXPECT_EQ(state.buttons, 1U);
  EXPECT_TRUE(the_events.empty());
  ASSERT_GT(the_flags.size(), 2U);
  EXPECT_EQ(the_flags.front(), static_cast<unsigned>(LIBEVDEV_READ_FLAG_NORMAL));
  EXPECT_EQ(the_flags[1], static_cast<unsigned>(LIBEVDEV_READ_FLAG_SYNC));
}

TEST(EvdevTake, LeavesWhatIsTooMuchForOneTick) {
  const Events mouse = device_with(EV_REL, {REL_X, REL_Y});
  evdev_state state = begun(mouse.get());
  the_events.assign(3 * EVDEV_EVENTS_MOST, {LIBEVDEV_READ_STATUS_SUCCESS, event_of(EV_REL, REL_X, 1)});
  EXPECT_EQ(evdev_take(&state, next, mouse.get()), 1);
  EXPECT_EQ(the_events.size(), 2U * EVDEV_EVENTS_MOST);
  the_events = {{-ENODEV, {}}};
  EXPECT_EQ(evdev_take(&state, next, mouse.get()), 0) << "unplugged";
}

}  // namespace
}  // namespace forcebound::driver
#endif

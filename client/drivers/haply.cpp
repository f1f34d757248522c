// Haply's Inverse3 with a VerseGrip if there is one, through Haply's Inverse service 3.1 or later, which runs on the
// user's computer and is looked for when the device is opened.
//
// Interface: JSON over a WebSocket on port 10001, as docs.haply.co/inverseSDK (3.1 to 3.5: websocket-protocol,
// simulation, control-commands, basis) and public programs describe it:
//  - the service first lists its devices, then sends one state for each message that it gets;
//  - a force holds for one message: the device becomes idle if none comes, after a time that is not published;
//  - force and position have x to the right, y forward, z up; the origin is at the device's base, so that the middle of
//    the workspace is a guess here (x_m, y_m, z_m);
//  - `set_cursor_force` has `values` in 3.1 and `vector` in 3.5, which also numbers sessions: so we know which;
//  - `verse_grip` has a `button`, `wireless_verse_grip` has `buttons`, both an `orientation` in the same axes.
//
// Each exchange takes a while, so it has a thread of its own:
//
//     transport's thread: state            -> readings mailbox -> tick
//                         set_cursor_force <- commands mailbox <- tick
//
// It sends zero force once no command has come for kHold_s. A service that does not answer for as long, or no longer
// lists the device, is left and looked for every half second.
//
// Never tried on hardware: tested against a service with this interface and a simulated device behind it.
#include <forcebound/driver/forcebound_device.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>

#include "haply_connection.hpp"
#include "haply_message.hpp"
#include "mailbox.h"
#include "pause.h"

namespace {

using namespace forcebound::haply;
using std::chrono::milliseconds;

constexpr double kHold_s = 0.02;
constexpr milliseconds kAnswer{20};
constexpr milliseconds kOpening{2000};
constexpr milliseconds kReopening{500};
constexpr long kLookAgain_ns = 500'000'000;
constexpr long kPause_ns = 150'000;
constexpr int kPriority = 79;
constexpr const char* kAccepted =
    "accepted are address=IP:PORT, device_id=ID, force_N_max=N, spelling=vector|values|auto and x_m=, y_m=, z_m=M";

enum class Trouble { none, no_service, no_device, not_understood };
constexpr int kReadingNumbers = 12;  // latched [s], x, y, z, trouble, has, buttons, w, x, y, z
constexpr int kCommandNumbers = 4;   // at [s], x, y, z

struct Settings {
  std::string address = "127.0.0.1";
  std::uint16_t port = 10001;
  std::string device_id{};  ///< empty: the first
  double force_N_max = 5;   ///< a guess, well below the motors' peak
  Spelling spelling = Spelling::automatic;
  Axes middle_m{0, -0.12, 0.15};  ///< of the workspace, where the documentation's examples have the cursor
};

bool read_number(const char* text, double& number) {
  const char* const end = text + std::strlen(text);
  double read = 0;
  const auto [stopped, error] = std::from_chars(text, end, read);
  if (error != std::errc() || stopped != end) return false;
  number = read;
  return true;
}

bool read_address(const std::string& text, Settings& settings) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return false;
  const std::string host = text.substr(0, colon);
  double port = 0;
  if (!read_number(text.c_str() + colon + 1, port) || !(port >= 1 && port <= 65535)) return false;
  settings.address = host == "localhost" ? "127.0.0.1" : host;
  settings.port = static_cast<std::uint16_t>(port);
  return settings.port == port;
}

bool read_spelling(const std::string& text, Settings& settings) {
  if (text == "vector") settings.spelling = Spelling::vector;
  if (text == "values") settings.spelling = Spelling::values;
  return text == "vector" || text == "values" || text == "auto";
}

bool read_setting(const forcebound_setting& setting, Settings& settings) {
  const std::string key = setting.key;
  double number = 0;
  if (key == "address") return read_address(setting.value, settings);
  if (key == "spelling") return read_spelling(setting.value, settings);
  if (key == "device_id") {
    settings.device_id = setting.value;
    return is_device_id(settings.device_id);
  }
  if (!read_number(setting.value, number)) return false;
  if (key == "force_N_max") {
    settings.force_N_max = number;
    return number > 0 && number <= 100;
  }
  if (key != "x_m" && key != "y_m" && key != "z_m") return false;
  settings.middle_m.at(static_cast<std::size_t>(key[0] - 'x')) = number;
  return number >= -1 && number <= 1;
}

std::string place_of(const Settings& settings) { return settings.address + ":" + std::to_string(settings.port); }

}  // namespace

struct forcebound_device {
  Settings settings;
  Spelling spelling = Spelling::vector;  ///< of this service
  Connection connection;
  bool introduces = false;  ///< the next command is the first of a session
  std::string text;
  std::uint64_t taken = 0;  ///< readings that the tick has taken
  mailbox readings{};
  mailbox commands{};
  std::atomic<bool> stopping{false};
  std::atomic<bool> ending{false};
  bool runs = false;
  pthread_t thread{};
  std::array<char, FORCEBOUND_TEXT_BYTES> error{};
};

namespace {

/// Finds service and device: none. Otherwise `why` gets one line.
Trouble find(forcebound_device& device, milliseconds limit, std::string& why) {
  Settings& settings = device.settings;
  const std::string place = place_of(settings);
  const auto refuse = [&](Trouble trouble, const std::string& reason) {
    why = reason;
    device.connection.close();
    return trouble;
  };
  if (!device.connection.open(settings.address, settings.port, limit)) {
    return refuse(Trouble::no_service,
                  "no Inverse service at " + place + " (" + device.connection.why() +
                      "): looked for its WebSocket, which versions 3.1 and later have on port 10001; it comes with "
                      "Haply Hub, see docs.haply.co");
  }
  const std::optional<std::string_view> first = device.connection.receive(limit);
  if (!first) {
    return refuse(Trouble::no_service,
                  "what listens at " + place + " does not begin with a list: " + device.connection.why());
  }
  const std::optional<Inventory> inventory = parse_inventory(*first);
  if (!inventory) {
    return refuse(
        Trouble::not_understood,
        "what listens at " + place + " is no Inverse service 3.1 or later: its first message has no list 'inverse3'");
  }
  std::string listed;
  bool is_there = false;
  for (const std::string& id : inventory->device_ids) {
    if (settings.device_id.empty()) settings.device_id = id;
    is_there = is_there || id == settings.device_id;
    listed += (listed.empty() ? "" : ", ") + id;
  }
  if (!is_there) {
    return refuse(Trouble::no_device, "no Inverse3 " + settings.device_id + (settings.device_id.empty() ? "" : " ") +
                                          "among those that the service at " + place +
                                          " lists: " + (listed.empty() ? "none" : listed));
  }
  const Spelling usual = inventory->has_sessions ? Spelling::vector : Spelling::values;
  device.spelling = settings.spelling == Spelling::automatic ? usual : settings.spelling;
  device.introduces = inventory->has_sessions;
  return Trouble::none;
}

const std::string& command_of(forcebound_device& device, const Axes& force_N) {
  write_command({.device_id = device.settings.device_id,
                 .force_N = force_N,
                 .spelling = device.spelling,
                 .introduces = device.introduces},
                device.text);
  device.introduces = false;
  return device.text;
}

/// The newest that the tick commanded; none if that is too old.
Axes force_due(const forcebound_device& device) {
  std::array<double, kCommandNumbers> command{};
  const bool is_there = mailbox_read(&device.commands, command.data(), kCommandNumbers) > 0;
  if (!is_there || now_s() - command[0] > kHold_s || device.stopping.load(std::memory_order_acquire)) return {};
  return {command[1], command[2], command[3]};
}

void hand_over(forcebound_device& device, double latched_s, const State& state) {
  const Axes& middle_m = device.settings.middle_m;
  const std::uint32_t has =
      (state.has_orientation ? FORCEBOUND_HAS_ORIENTATION : 0U) | (state.has_buttons ? FORCEBOUND_HAS_BUTTONS : 0U);
  const std::array<double, kReadingNumbers> numbers{latched_s,
                                                    state.position_m[0] - middle_m[0],
                                                    state.position_m[1] - middle_m[1],
                                                    state.position_m[2] - middle_m[2],
                                                    static_cast<double>(Trouble::none),
                                                    static_cast<double>(has),
                                                    static_cast<double>(state.buttons),
                                                    state.orientation[0],
                                                    state.orientation[1],
                                                    state.orientation[2],
                                                    state.orientation[3]};
  mailbox_write(&device.readings, numbers.data(), kReadingNumbers);
}

/// Sends the force that is due and takes the answer, until something is wrong or the device is closed.
Trouble exchange_all(forcebound_device& device) {
  double understood_s = now_s();
  while (!device.ending.load(std::memory_order_acquire)) {
    const double sent_s = now_s();
    if (!device.connection.send(command_of(device, force_due(device)), kAnswer)) return Trouble::no_service;
    // Together no longer than kAnswer, so that a force has a bound.
    const auto sending = milliseconds(static_cast<int>(std::ceil(1e3 * (now_s() - sent_s))));
    const std::optional<std::string_view> text = device.connection.receive(kAnswer - std::min(sending, kAnswer));
    if (!text) return Trouble::no_service;
    State state;
    const double received_s = now_s();
    const Answer answer = parse_state(*text, device.settings.device_id, state);
    if (answer == Answer::gone) return Trouble::no_device;
    if (answer == Answer::state) {
      hand_over(device, 0.5 * (sent_s + received_s), state);
      understood_s = received_s;
    }
    if (received_s - understood_s > kHold_s) return Trouble::not_understood;
    rest(kPause_ns);
  }
  return Trouble::none;
}

void look_again(forcebound_device& device, Trouble trouble) {
  std::string why;
  while (trouble != Trouble::none && !device.ending.load(std::memory_order_acquire)) {
    std::array<double, kReadingNumbers> gone{};
    gone[4] = static_cast<double>(trouble);
    mailbox_write(&device.readings, gone.data(), kReadingNumbers);
    trouble = find(device, kReopening, why);
    if (trouble != Trouble::none) rest(kLookAgain_ns);
  }
}

void exchange(forcebound_device& device) {
  while (!device.ending.load(std::memory_order_acquire)) {
    Trouble trouble = Trouble::no_service;
    try {
      trouble = exchange_all(device);
    } catch (const std::exception&) {  // no memory: as if the service were gone
    }
    device.connection.close(command_of(device, {}));
    look_again(device, trouble);
  }
}

void* transport(void* of) {
  const sched_param priority{.sched_priority = kPriority};
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
  auto& device = *static_cast<forcebound_device*>(of);
  try {
    exchange(device);
  } catch (const std::exception&) {
    device.connection.close();
  }
  return nullptr;
}

int haply_open(const forcebound_setting* settings, size_t count, forcebound_device** opened, char* error,
               size_t error_bytes) {
  try {
    auto device = std::make_unique<forcebound_device>();
    for (size_t i = 0; i < count; ++i) {
      if (read_setting(settings[i], device->settings)) continue;
      std::snprintf(error, error_bytes, "'%s=%s' is not accepted; %s", settings[i].key, settings[i].value, kAccepted);
      return FORCEBOUND_FAILED;
    }
    std::string why;
    if (find(*device, kOpening, why) != Trouble::none) {
      std::snprintf(error, error_bytes, "%s", why.c_str());
      return FORCEBOUND_FAILED;
    }
    *opened = device.release();
    return FORCEBOUND_OK;
  } catch (const std::exception& thrown) {
    std::snprintf(error, error_bytes, "%s", thrown.what());
    return FORCEBOUND_FAILED;
  }
}

int haply_describe(forcebound_device* device, forcebound_facts* facts) {
  facts->degrees_of_freedom = 3;
  std::snprintf(facts->name, sizeof facts->name, "Inverse3 %s", device->settings.device_id.c_str());
  facts->identified = 0;  // its maker publishes neither damping nor friction
  facts->period_s = 1e-3;
  for (int axis = 0; axis < 3; ++axis) {
    facts->damping[4 * axis] = 0.5;
    facts->encoder_step[axis] = 1e-4;
  }
  facts->force_N_max = device->settings.force_N_max;
  // The oldest force that is sent, an exchange that is not answered, and the last attempt to send zero force.
  facts->hold_s_max = kHold_s + 1e-3 * static_cast<double>((kAnswer + Connection::kLast).count()) + 1e-9 * kPause_ns;
  facts->latency_s = 2e-3;
  facts->stamp_s_most = 2e-3;
  return FORCEBOUND_OK;
}

int haply_start(forcebound_device* device) {
  if (device->runs) return FORCEBOUND_OK;
  if (pthread_create(&device->thread, nullptr, transport, device) != 0) {
    std::snprintf(device->error.data(), device->error.size(), "no thread for the device");
    return FORCEBOUND_FAILED;
  }
  device->runs = true;
  return FORCEBOUND_OK;
}

void say(forcebound_device& device, Trouble trouble) {
  const char* const id = device.settings.device_id.c_str();
  const char* const address = device.settings.address.c_str();
  const int port = device.settings.port;
  char* const to = device.error.data();
  const std::size_t bytes = device.error.size();
  if (trouble == Trouble::no_service) {
    std::snprintf(to, bytes, "the Inverse service at %.40s:%d does not answer; looking for it", address, port);
  } else if (trouble == Trouble::no_device) {
    std::snprintf(to, bytes, "Inverse3 %.64s is unplugged; looking for it", id);
  } else {
    std::snprintf(to, bytes, "the Inverse service at %.40s:%d tells no position of Inverse3 %.64s; looking for it",
                  address, port, id);
  }
}

int haply_read(forcebound_device* device, int64_t now_ns, forcebound_reading* reading) {
  std::array<double, kReadingNumbers> newest{};
  const std::uint64_t writes = mailbox_read(&device->readings, newest.data(), kReadingNumbers);
  if (writes == 0 || writes == device->taken) return FORCEBOUND_STALE;
  const auto trouble = static_cast<Trouble>(static_cast<int>(newest[4]));
  if (trouble != Trouble::none) {
    say(*device, trouble);
    return FORCEBOUND_UNPLUGGED;
  }
  device->taken = writes;
  reading->latched_ns =
      std::min(static_cast<int64_t>(1e9 * newest[0]), now_ns);  // it may have come since the tick began
  std::memcpy(reading->position_m, newest.data() + 1, 3 * sizeof(double));
  reading->has = static_cast<std::uint32_t>(newest[5]);
  reading->buttons = static_cast<std::uint32_t>(newest[6]);
  std::memcpy(reading->orientation, newest.data() + 7, 4 * sizeof(double));
  return FORCEBOUND_OK;
}

int haply_command(forcebound_device* device, const forcebound_command* command) {
  const std::array<double, kCommandNumbers> numbers{1e-9 * static_cast<double>(command->at_ns), command->force_N[0],
                                                    command->force_N[1], command->force_N[2]};
  mailbox_write(&device->commands, numbers.data(), kCommandNumbers);
  device->stopping.store(false, std::memory_order_release);
  return FORCEBOUND_OK;
}

void haply_stop(forcebound_device* device) { device->stopping.store(true, std::memory_order_release); }

void haply_close(forcebound_device* device) {
  if (device->runs) {
    device->ending.store(true, std::memory_order_release);
    pthread_join(device->thread, nullptr);
  }
  delete device;
}

const char* haply_last_error(forcebound_device* device) { return device->error.data(); }

constexpr forcebound_driver kHaply{
    .size = sizeof(forcebound_driver),
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "haply",
    .description = "Inverse3, with a VerseGrip if there is one, by Haply's Inverse service",
    .settings =
        "  address=IP:PORT  of the service; 127.0.0.1:10001 unless said\n"
        "  device_id=ID     of several; the first unless said\n"
        "  force_N_max=N    largest force; 5 unless said\n"
        "  spelling=WORD    of a force: vector, values or auto, by the service\n"
        "  x_m=M y_m= z_m=  middle of the workspace; 0, -0.12, 0.15 unless said\n",
    .open = haply_open,
    .describe = haply_describe,
    .start = haply_start,
    .read = haply_read,
    .command = haply_command,
    .stop = haply_stop,
    .close = haply_close,
    .last_error = haply_last_error,
    // A device, not a robot.
    .describe_robot = nullptr,
    .read_robot = nullptr,
    .command_robot = nullptr,
    .resume = nullptr,
};

}  // namespace

extern "C" const forcebound_driver* forcebound_driver_entry(std::uint32_t /*wanted*/) { return &kHaply; }

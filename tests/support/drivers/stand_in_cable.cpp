#include "tests/support/drivers/stand_in_cable.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "tests/support/drivers/stand_in_device.hpp"

namespace forcebound::test {
namespace {

enum class Wish : std::uint32_t { read, command, enable, set_hold, plug, press, look };

struct Request {
  Wish wish = Wish::read;
  std::uint32_t buttons = 0;
  Axes numbers{};
};

struct Answer {
  std::uint64_t done = 0;
  StandIn::State state{};
};

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(Descriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

Descriptor new_socket() { return Descriptor(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)); }

using SocketCall = int (*)(int, const sockaddr*, socklen_t);

void at(const std::string& path, const Descriptor& socket, SocketCall call) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    throw std::runtime_error("stand-in: the socket's path must be shorter than " +
                             std::to_string(sizeof address.sun_path) + " bytes, got '" + path + "'");
  }
  path.copy(address.sun_path, path.size());
  if (call(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return;
  throw std::runtime_error("stand-in: " + path + ": " + std::strerror(errno));
}

class FarDevice final : public StandIn {
 public:
  explicit FarDevice(const std::string& path) : socket_(new_socket()) { at(path, socket_, ::connect); }

  [[nodiscard]] std::optional<State> read() override {
    const Answer answer = ask({.wish = Wish::read});
    return answer.done != 0 ? std::optional(answer.state) : std::nullopt;
  }
  bool command(const Axes& force_N) override { return ask({.wish = Wish::command, .numbers = force_N}).done != 0; }
  bool enable(bool on) override { return ask({.wish = Wish::enable, .buttons = on}).done != 0; }
  bool set_hold(double hold_s) override { return ask({.wish = Wish::set_hold, .numbers = {hold_s, 0, 0}}).done != 0; }
  void plug(bool in) override { ask({.wish = Wish::plug, .buttons = in}); }
  void press(std::uint32_t buttons) override { ask({.wish = Wish::press, .buttons = buttons}); }
  [[nodiscard]] State look() override { return ask({.wish = Wish::look}).state; }

 private:
  Answer ask(const Request& request) {
    const std::scoped_lock lock(guard_);
    Answer answer;
    const bool asked = ::send(socket_.number(), &request, sizeof request, MSG_NOSIGNAL) == sizeof request;
    if (!asked || ::recv(socket_.number(), &answer, sizeof answer, 0) != sizeof answer) return {};
    return answer;
  }

  std::mutex guard_;
  Descriptor socket_;
};

Answer answer_to(const Request& request, StandIn& device) {
  switch (request.wish) {
    case Wish::read: {
      const std::optional<StandIn::State> state = device.read();
      return {.done = state.has_value(), .state = state.value_or(StandIn::State{})};
    }
    case Wish::command:
      return {.done = device.command(request.numbers)};
    case Wish::enable:
      return {.done = device.enable(request.buttons != 0)};
    case Wish::set_hold:
      return {.done = device.set_hold(request.numbers[0])};
    case Wish::plug:
      device.plug(request.buttons != 0);
      break;
    case Wish::press:
      device.press(request.buttons);
      break;
    case Wish::look:
      break;
  }
  return {.done = 1, .state = device.look()};
}

/// False: the library is gone.
bool answered(const Descriptor& library, StandIn& device) {
  Request request;
  if (::recv(library.number(), &request, sizeof request, 0) != sizeof request) return false;
  const Answer answer = answer_to(request, device);
  return ::send(library.number(), &answer, sizeof answer, MSG_NOSIGNAL) == sizeof answer;
}

}  // namespace

std::unique_ptr<StandIn> plug_into(const std::string& socket) { return std::make_unique<FarDevice>(socket); }

void serve(StandIn& device, const std::string& socket, int until) {
  const Descriptor door = new_socket();
  ::unlink(socket.c_str());
  at(socket, door, ::bind);
  constexpr int kWaiting = 8;
  if (::listen(door.number(), kWaiting) != 0) throw std::runtime_error("stand-in: " + socket + ": nobody can connect");
  std::vector<Descriptor> libraries;
  while (true) {
    std::vector<pollfd> waits{{.fd = until, .events = POLLIN, .revents = 0},
                              {.fd = door.number(), .events = POLLIN, .revents = 0}};
    for (const Descriptor& library : libraries) {
      waits.push_back({.fd = library.number(), .events = POLLIN, .revents = 0});
    }
    if (::poll(waits.data(), waits.size(), -1) < 0 && errno != EINTR) break;
    if (waits[0].revents != 0) break;
    std::erase_if(libraries, [&](const Descriptor& library) {
      const auto wait = std::ranges::find(waits, library.number(), &pollfd::fd);
      return wait->revents != 0 && !answered(library, device);
    });
    if (waits[1].revents != 0) libraries.emplace_back(::accept4(door.number(), nullptr, nullptr, SOCK_CLOEXEC));
  }
  ::unlink(socket.c_str());
}

std::unique_ptr<StandIn> stand_in_of_environment() {
  const char* const socket = std::getenv("FORCEBOUND_STAND_IN_SOCKET");
  if (socket != nullptr && *socket != '\0') return plug_into(socket);
  return std::make_unique<StandInDevice>(StandInSettings::from_environment());
}

}  // namespace forcebound::test

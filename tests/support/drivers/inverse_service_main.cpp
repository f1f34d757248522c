// Stands in for Haply's Inverse service: `inverse-service PORT [3.1]`, a WebSocket server on 127.0.0.1 with a simulated
// device behind it, which the environment sets up (stand_in_device.hpp; the hold time is 0.1 s unless said). PORT 0: a
// free one. It says on which port it listens, takes a command from each line of standard input (inverse_service.hpp),
// and runs until SIGINT or SIGTERM.
#include <poll.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <thread>

#include "forcebound/time/real_time.hpp"
#include "tests/support/drivers/end_signals.hpp"
#include "tests/support/drivers/inverse_service.hpp"

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using forcebound::test::InverseService;
using Stream = beast::websocket::stream<tcp::socket>;

constexpr double kHold_s = 0.1;
constexpr int kPriority = 80;  // above the driver's, which waits for it

void write(Stream& stream, InverseService& service, const std::string& text) {
  service.wait_while_muted();
  stream.write(asio::buffer(text));
}

void converse(tcp::socket socket, InverseService& service) {
  try {
    socket.set_option(tcp::no_delay(true));
    Stream stream(std::move(socket));
    stream.accept();
    stream.text(true);
    write(stream, service, service.begin_session());
    beast::flat_buffer received;
    for (;;) {
      received.consume(received.size());
      stream.read(received);
      const auto bytes = received.data();
      write(stream, service, service.answer({static_cast<const char*>(bytes.data()), bytes.size()}));
    }
  } catch (const std::exception&) {  // the client is gone
  }
  service.end_session();
}

[[noreturn]] void listen(tcp::acceptor acceptor, InverseService& service) {
  for (;;) std::thread(converse, acceptor.accept(), std::ref(service)).detach();
}

void obey_lines(std::string& heard, InverseService& service) {
  for (std::size_t end = heard.find('\n'); end != std::string::npos; end = heard.find('\n')) {
    const std::string line = heard.substr(0, end);
    heard.erase(0, end + 1);
    if (!service.obey(line)) std::fprintf(stderr, "inverse-service: '%s' is no command\n", line.c_str());
  }
}

/// Takes commands until a signal comes.
void run(int until, InverseService& service) {
  std::string heard;
  std::array<pollfd, 2> waits{
      {{.fd = until, .events = POLLIN, .revents = 0}, {.fd = 0, .events = POLLIN, .revents = 0}}};
  for (;;) {
    ::poll(waits.data(), waits.size(), -1);
    if (waits[0].revents != 0) return;
    if (waits[1].revents == 0) continue;
    std::array<char, 4096> bytes{};
    const ssize_t count = ::read(0, bytes.data(), bytes.size());
    if (count <= 0) waits[1].fd = -1;
    if (count > 0) heard.append(bytes.data(), static_cast<std::size_t>(count));
    obey_lines(heard, service);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string version = argc == 3 ? argv[2] : "3.5";
  if (argc < 2 || argc > 3 || (version != "3.1" && version != "3.5")) {
    std::fputs("usage: inverse-service PORT [3.1|3.5]\n", stderr);
    return 2;
  }
  try {
    const int until = forcebound::test::end_signals();
    (void)forcebound::time::ask_for_real_time(kPriority);
    const std::unique_ptr<forcebound::test::StandIn> device = forcebound::test::stand_in_of_environment();
    if (std::getenv("FORCEBOUND_STAND_IN_HOLD_S") == nullptr) device->set_hold(kHold_s);
    InverseService service(*device, version == "3.5");
    asio::io_context io;
    tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), static_cast<unsigned short>(std::atoi(argv[1]))});
    std::printf("listening on port %d\n", acceptor.local_endpoint().port());
    std::fflush(stdout);
    std::thread([&] { listen(std::move(acceptor), service); }).detach();
    run(until, service);
    const forcebound::test::StandIn::State end = device->look();
    std::printf("P %.6g J, least P %.6g J\n", end.energy_J, end.least_energy_J);
    std::fflush(stdout);
    std::_Exit(0);  // threads of clients go on meanwhile
  } catch (const std::exception& error) {
    std::fprintf(stderr, "inverse-service: %s\n", error.what());
    return 1;
  }
}

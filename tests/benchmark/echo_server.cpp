// A minimal server that sends every datagram back: the reference for forcebound-server's capacity.
//
//     echo_server PORT    on 127.0.0.1, until it is killed

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<in_port_t>(argc == 2 ? std::atoi(argv[1]) : 0));
  const int server = socket(AF_INET, SOCK_DGRAM, 0);
  // The same buffer size as forcebound-server.
  const int buffer_bytes = 1 << 20;
  setsockopt(server, SOL_SOCKET, SO_RCVBUF, &buffer_bytes, sizeof buffer_bytes);
  setsockopt(server, SOL_SOCKET, SO_SNDBUF, &buffer_bytes, sizeof buffer_bytes);
  if (argc != 2 || bind(server, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    std::fputs("echo_server: needs a free port as its argument\n", stderr);
    return 1;
  }
  std::array<char, 2048> buffer;
  for (;;) {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    auto* peer = reinterpret_cast<sockaddr*>(&from);
    const ssize_t bytes = recvfrom(server, buffer.data(), buffer.size(), 0, peer, &size);
    if (bytes >= 0) sendto(server, buffer.data(), static_cast<size_t>(bytes), 0, peer, size);
  }
}

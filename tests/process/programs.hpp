#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/process.hpp"

/// The real programs on the loopback, with the usual options of tests.
namespace forcebound::test {

using Words = std::vector<std::string>;

extern const char* const kForcebound;
extern const char* const kServer;
extern const char* const kClient;
extern const char* const kRelay;
extern const char* const kLab;
extern const char* const kRos2;  ///< null: not built

/// The exit code of a program whose driver of a device or robot crashed.
inline constexpr int kDriverCrashed = 6;

/// A program that listens on a port of the system's choice, or on `at`; returns once it does.
class Listener : public Process {
 public:
  /// @throws std::runtime_error with its output if it does not.
  Listener(const char* program, const Words& arguments, const std::string& at = "127.0.0.1:0");

  /// HOST:PORT.
  [[nodiscard]] const std::string& address() const { return address_; }

 private:
  std::string address_;
};

class Server : public Listener {
 public:
  explicit Server(const Words& arguments = {}, const std::string& at = "127.0.0.1:0")
      : Listener(kServer, arguments, at) {}
};

class Relay : public Listener {
 public:
  Relay(const std::string& upstream, const Words& arguments);

  /// Waits, after the client's end, until nothing is under way any more. That is a time, many times the delay of the
  /// tests' networks: nobody sees from outside what waits in a relay.
  static void let_everything_arrive();
};

/// Where a client writes its summary; a base, to be there before the program starts.
class SummaryFile {
 protected:
  TemporaryFolder summary_folder_;
};

/// A client that writes its summary into a file of its own.
class Client : private SummaryFile, public Process {
 public:
  Client(const std::string& server, const Words& arguments);

  /// Its summary as text, and parsed; null if there is none.
  [[nodiscard]] std::string summary_text() const { return content(summary_folder_.file("summary.json")); }
  [[nodiscard]] nlohmann::json summary() const { return nlohmann::json::parse(summary_text(), nullptr, false); }

  /// The exit code of a run that ended well, once it has: 3 if its summary says that it was not passive, which the
  /// published laws do not exclude on a machine that is late.
  [[nodiscard]] int expected_end() const;
};

/// Runs a program to its end.
struct Ran {
  int exit_code = -1;  ///< -1: it did not end
  std::string out;
  std::string err;
};
Ran run(const char* program, const Words& arguments, std::chrono::nanoseconds limit = std::chrono::seconds{60});

/// HOST:PORT of a port that is closed, for UDP and TCP, and that Linux by default gives to nobody who does not ask for
/// it.
std::string free_address();

/// The number in front of `what` in the counts that a program prints at its end ("12 reordered"); 0 where it is not
/// mentioned.
std::uint64_t counted(const std::string& text, std::string_view subject, std::string_view what);

/// `text` with single spaces for all space: programs break their lines where the column ends.
std::string unwrapped(std::string_view text);

/// How often `text` has `part`.
std::size_t occurrences(std::string_view text, std::string_view part);

/// How many lines.
std::size_t lines(std::string_view text);

}  // namespace forcebound::test

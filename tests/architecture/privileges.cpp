#include "tests/architecture/privileges.hpp"

#include <algorithm>
#include <array>
#include <regex>

#include "tests/architecture/source_text.hpp"

namespace forcebound::architecture {
namespace {

// Programs, and code that runs the core on threads and sockets. Tests may too, except for the tools that ship.
constexpr std::string_view kShells =
    R"((client|server)/forcebound/(client|server)/(app|commands|ros2|runtime)/.*|client/(drivers|library|python)/.*|)"
    R"(common/forcebound/program/.*|tests/tools/(demo|relay|lab)/.*|tests/(?!tools/).*)";
constexpr std::string_view kShellsInWords =
    "the folders app, commands, ros2, runtime and common/forcebound/program, client/drivers, client/library, "
    "client/python, "
    "tests/tools/demo, tests/tools/relay, tests/tools/lab and the tests";

// It waits for a process that reads untrusted files.
constexpr std::string_view kChild = R"(common/forcebound/child/in_child\.cpp)";

// They stop what a driver that crashed has left, on another thread and within a time.
constexpr std::string_view kCrash = R"(common/forcebound/driver/(crash|opened_driver)\.cpp)";

// What only some files may contain: `pattern` is matched against a line without its comment, each of `where` against
// the path.
struct Privilege {
  std::string_view name;
  std::string_view pattern;
  std::array<std::string_view, 4> where;  // those after the last are empty
  std::string_view owner;
};

constexpr Privilege kPrivileges[] = {
    {"Asio",
     R"(#include\s*[<"]asio)",
     {kShells, "common/forcebound/net/(internal/)?udp.*"},
     "common/forcebound/net/udp* and the shells"},
    {"Boost.Asio and Boost.Beast",
     R"(#include\s*<boost/(asio|beast)[/.])",
     {R"(common/forcebound/page/(internal/.*|page_server\.cpp)|common/forcebound/http/client\.cpp|)"
      R"(client/drivers/.*|tests/(unit/page|process)/page_.*|tests/support/drivers/.*)"},
     "common/forcebound/page/page_server.cpp with its internal headers, common/forcebound/http/client.cpp, "
     "client/drivers, and the tests of pages and drivers"},
    {"generated Protocol Buffers code",
     R"(#include\s*[<"].*\.pb\.h[">])",
     {R"(common/forcebound/(wire|handover)/internal/.*|common/forcebound/(wire|record|handover)/.*\.cpp|tests/(?!tools/).*)"},
     "internal headers of common/forcebound/wire and handover, and the .cpp files of common/forcebound/wire, record "
     "and handover"},
    {"the TOML library",
     R"(^\s*#include\s*[<"]toml\+\+/)",
     {"common/forcebound/config/node\\.cpp"},
     "common/forcebound/config/node.cpp"},
    {"logging", R"(#include\s*[<"]spdlog/)", {kShells}, kShellsInWords},
    {"command lines", R"(#include\s*[<"]CLI/)", {kShells}, kShellsInWords},
    {"threads",
     R"(#include\s*<(thread|future|mutex|shared_mutex|condition_variable|semaphore|latch|barrier|)"
     R"(pthread\.h)>|std::(jthread|thread|async)\b)",
     {kShells,
      R"(common/forcebound/time/real_time\.cpp|common/forcebound/record/idle_thread\.hpp|)"
      R"(client/forcebound/client/rendering/scene_builder\.hpp|)"
      R"(client/forcebound/client/security/handshaker\.hpp|common/forcebound/page/page_server\.cpp|)"
      R"(common/forcebound/text/classic_locale\.cpp|)"
      R"(client/forcebound/client/page/live_page\.hpp|server/forcebound/server/session/shared_limits\.hpp|)"
      R"(server/forcebound/server/environment/scene_library\.cpp|)"
      R"(server/forcebound/server/follower/(follower_thread|robot_guard)\.[ch]pp|)"
      R"(common/forcebound/law_plugin/known_laws\.cpp|)"
      R"(server/forcebound/server/security/moved_keys\.hpp|)"
      R"(common/forcebound/net/(name_lookup\.cpp|peer_link\.hpp))",
      kCrash, kChild},
     "common/forcebound/time/real_time.cpp, common/forcebound/record/idle_thread.hpp, which measures one, the "
     "client's scene_builder.hpp and handshaker.hpp, whose counts "
     "and texts another thread reads, the client's live_page.hpp, which two threads use, "
     "the server's shared_limits.hpp, moved_keys.hpp and scene_library.cpp, which all workers share, follower_thread "
     "and robot_guard, which drive a robot, "
     "common/forcebound/law_plugin/known_laws.cpp, since loaded laws are of the process, "
     "common/forcebound/net/name_lookup.cpp, which waits for name servers, and peer_link.hpp, whose news another "
     "thread takes, common/forcebound/page/page_server.cpp, common/forcebound/text/classic_locale.cpp, since the "
     "locale is of all threads, common/forcebound/driver's crash.cpp and opened_driver.cpp, which stop what a driver "
     "that crashed has left, common/forcebound/child and the shells"},
    {"sockets",
     R"(#include\s*<(sys/socket|sys/epoll|poll|netdb|netinet/.*)(\.h)?>)",
     {kShells, "common/forcebound/net/(internal/)?udp.*", kChild},
     "common/forcebound/net/udp*, common/forcebound/child and the shells"},
    {"the system's clock",
     R"((system|steady|high_resolution)_clock\b|\bclock_(gettime|nanosleep)\b|\bgettimeofday\b|)"
     R"(\bnanosleep\b|std::this_thread|#include\s*"forcebound/time/(steady_clock|periodic_timer|real_time))",
     {kShells,
      R"(common/forcebound/net/(internal/)?udp.*|)"
      R"(common/forcebound/time/(steady_clock|periodic_timer|real_time)\.[ch]pp|)"
      R"(server/forcebound/server/follower/(follower_thread|robot_guard)\.cpp|)"
      R"(common/forcebound/record/idle_thread\.cpp)",
      kCrash, kChild},
     "common/forcebound/time's steady_clock, periodic_timer and real_time, common/forcebound/record/idle_thread.cpp, "
     "the server's follower_thread and robot_guard, "
     "common/forcebound/driver's crash.cpp and opened_driver.cpp, common/forcebound/child and the shells"},
    {"random numbers without a seed of ours",
     R"(\bstd::random_device\b|\b(std::)?s?rand\(|\bgetrandom\(|\brandombytes|\bfill_with_random\()",
     {kShells, R"(common/forcebound/security/random\.[ch]pp|common/forcebound/page/listen_address\.cpp)"},
     "common/forcebound/security/random, which gives keys, common/forcebound/page/listen_address.cpp, which gives "
     "tokens, and the shells, which draw a seed once and print it"},
    {"numbers by the process's locale",
     R"(std::o?stringstream\b|\b(setlocale|uselocale|imbue)\b|std::locale::global|)"
     R"(\b(v?sscanf|fscanf|ato[fil]l?|strto(d|f|ld)|std::sto(d|f|ld))\s*\(|)"
     R"((^|[^.])%[-+ #0]*[0-9*]*(\.[0-9*]+)?[lL]?[efgaEFGA]\b|\{:[^{}]*L\}|)"
     R"(std::to_string\([^()]*_(s|ms|us|ns|m|mm|N|J|Hz|kg|rad|N_per_m|N_s_per_m)\))",
     {R"(common/forcebound/(control/classic_text\.hpp|text/classic_locale\.cpp|program/command_line\.cpp)|)"
      R"(client/library/examples/.*|tests/(?!tools/).*)"},
     "common/forcebound/control/classic_text.hpp and common/forcebound/text/classic_locale.cpp, which take the "
     "classic "
     "one, common/forcebound/program/command_line.cpp, which writes no number, client/library/examples and the tests"},
    {"libsodium",
     R"(#include\s*[<"]sodium)",
     {R"(common/forcebound/(security/.*|handover/hash)\.cpp|tests/unit/security/.*)"},
     "the .cpp files of common/forcebound/security, and their tests, and common/forcebound/handover/hash.cpp"},
};

/// A privilege with its expressions ready to be searched for.
struct ReadyPrivilege {
  const Privilege& is;
  std::regex pattern;
  std::vector<std::regex> where{};
};

const std::vector<ReadyPrivilege>& privileges() {
  static const std::vector<ReadyPrivilege> kReady = [] {
    std::vector<ReadyPrivilege> ready;
    for (const Privilege& privilege : kPrivileges) {
      ready.push_back({.is = privilege, .pattern = std::regex(std::string(privilege.pattern))});
      for (const std::string_view where : privilege.where) {
        if (!where.empty()) ready.back().where.emplace_back(std::string(where));
      }
    }
    return ready;
  }();
  return kReady;
}

}  // namespace

std::vector<Violation> privilege_violations(std::string_view file, std::string_view text) {
  std::vector<Violation> found;
  for_each_line(text, [&](int number, const std::string& code) {
    for (const ReadyPrivilege& privilege : privileges()) {
      if (!std::regex_search(code, privilege.pattern)) continue;
      const auto holds = [&](const std::regex& where) { return std::regex_match(file.begin(), file.end(), where); };
      if (std::ranges::any_of(privilege.where, holds)) continue;
      found.push_back(
          {std::string(file), number,
           "'" + code + "': " + std::string(privilege.is.name) + " belong only to " + std::string(privilege.is.owner)});
    }
  });
  return found;
}

}  // namespace forcebound::architecture

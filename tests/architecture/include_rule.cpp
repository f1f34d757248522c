#include "tests/architecture/include_rule.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <regex>
#include <span>
#include <sstream>

namespace forcebound::architecture {
namespace {

/// A folder, by the path prefix of includes of its headers, and the folders whose headers it may include, with all
/// below them.
struct Folder {
  std::string_view path;
  std::array<std::string_view, 16> known{};  // those after the last are empty

  [[nodiscard]] std::vector<std::string_view> knows() const {
    return {known.begin(), std::ranges::find(known, std::string_view())};
  }
};

constexpr Folder kFolders[] = {
    {"forcebound/control", {}},
    {"forcebound/text", {}},
    {"forcebound/time", {}},
    {"forcebound/program", {"forcebound/config", "forcebound/text"}},
    {"forcebound/config", {"forcebound/control", "forcebound/text"}},
    {"forcebound/baselines", {"forcebound/control", "forcebound/config", "forcebound/text"}},
    {"forcebound/local_model", {}},
    {"forcebound/wire", {"forcebound/control", "forcebound/local_model", "forcebound/time"}},
    {"forcebound/net", {"forcebound/text", "forcebound/time"}},
    {"forcebound/security", {"forcebound/config", "forcebound/text", "forcebound/time"}},
    {"forcebound/record", {"forcebound/control", "forcebound/text", "forcebound/time", "forcebound/wire"}},
    {"forcebound/device", {"forcebound/control", "forcebound/config", "forcebound/text", "forcebound/time"}},
    {"forcebound/child", {"forcebound/text"}},
    {"forcebound/driver",
     {"forcebound/child", "forcebound/control", "forcebound/device", "forcebound/text", "forcebound/time"}},
    {"forcebound/scene/geometry", {"forcebound/config", "forcebound/text"}},
    {"forcebound/scene/effects",
     {"forcebound/config", "forcebound/control", "forcebound/text", "forcebound/scene/geometry"}},
    {"forcebound/scene",
     {"forcebound/config", "forcebound/control", "forcebound/local_model", "forcebound/text", "forcebound/time"}},
    {"forcebound/handover", {"forcebound/config", "forcebound/text", "forcebound/scene"}},
    {"forcebound/page", {"forcebound/security", "forcebound/text"}},
    {"forcebound/view",
     {"forcebound/config", "forcebound/page", "forcebound/record", "forcebound/scene", "forcebound/text"}},
    {"forcebound/http", {"forcebound/text"}},
    {"forcebound/results", {"forcebound/record", "forcebound/text"}},
    {"forcebound/client/rendering",
     {"forcebound/control", "forcebound/local_model", "forcebound/text", "forcebound/time", "forcebound/wire",
      "forcebound/scene", "forcebound/handover"}},
    {"forcebound/client/security", {"forcebound/config", "forcebound/net", "forcebound/security", "forcebound/time"}},
    {"forcebound/client/session",
     {"forcebound/control", "forcebound/text", "forcebound/time", "forcebound/wire", "forcebound/net",
      "forcebound/record", "forcebound/device", "forcebound/local_model", "forcebound/client/rendering"}},
    {"forcebound/client/runtime",
     {"forcebound/control", "forcebound/scene", "forcebound/text", "forcebound/time", "forcebound/wire",
      "forcebound/net", "forcebound/record", "forcebound/security", "forcebound/device", "forcebound/view",
      "forcebound/client/rendering", "forcebound/client/security", "forcebound/client/session"}},
    {"forcebound/client/page",
     {"forcebound/control", "forcebound/config", "forcebound/text", "forcebound/time", "forcebound/net",
      "forcebound/record", "forcebound/device", "forcebound/scene", "forcebound/page", "forcebound/view",
      "forcebound/wire", "forcebound/client/session"}},
    {"forcebound/client/app",
     {"forcebound/control", "forcebound/baselines", "forcebound/program", "forcebound/text", "forcebound/time",
      "forcebound/wire", "forcebound/net", "forcebound/record", "forcebound/device", "forcebound/driver",
      "forcebound/scene", "forcebound/http", "forcebound/page", "forcebound/view", "forcebound/client"}},
    {"forcebound/client/commands",
     {"forcebound/baselines", "forcebound/child", "forcebound/client", "forcebound/control", "forcebound/device",
      "forcebound/driver", "forcebound/handover", "forcebound/net", "forcebound/program", "forcebound/record",
      "forcebound/results", "forcebound/security", "forcebound/text", "forcebound/time", "forcebound/wire"}},
    // It draws the scenes that ship.
    {"forcebound/client/commands/view",
     {"forcebound/client/commands", "forcebound/client/page", "forcebound/page", "forcebound/program",
      "forcebound/record", "forcebound/text", "forcebound/time", "forcebound/view", "forcebound/server/environment",
      "forcebound/server/robot"}},
    // The simulator stays beside the tests.
    {"python", {"forcebound", "tests/tools/netem", "tests/tools/sim"}},
    // Plug-ins: C, or C++, with no more of ours than the interface of drivers.
    {"drivers", {"forcebound/driver"}},
    {"forcebound/server/dynamics/tissue", {"forcebound/local_model", "forcebound/text", "forcebound/scene"}},
    {"forcebound/server/dynamics/bodies",
     {"forcebound/child", "forcebound/local_model", "forcebound/text", "forcebound/scene"}},
    {"forcebound/server/robot",
     {"forcebound/config", "forcebound/control", "forcebound/device", "forcebound/driver", "forcebound/local_model",
      "forcebound/text", "forcebound/time", "forcebound/server/dynamics/bodies"}},
    {"forcebound/server/environment",
     {"forcebound/config", "forcebound/control", "forcebound/device", "forcebound/local_model", "forcebound/text",
      "forcebound/time", "forcebound/scene", "forcebound/handover", "forcebound/view", "forcebound/server/dynamics"}},
    {"forcebound/server/follower",
     {"forcebound/control", "forcebound/device", "forcebound/local_model", "forcebound/scene", "forcebound/time",
      "forcebound/view", "forcebound/server/environment", "forcebound/server/robot"}},
    {"forcebound/server/session",
     {"forcebound/control", "forcebound/baselines", "forcebound/local_model", "forcebound/text", "forcebound/time",
      "forcebound/wire", "forcebound/net", "forcebound/scene", "forcebound/handover", "forcebound/view",
      "forcebound/server/environment"}},
    {"forcebound/server/security",
     {"forcebound/control", "forcebound/net", "forcebound/security", "forcebound/time", "forcebound/wire",
      "forcebound/server/session"}},
    {"forcebound/server/runtime",
     {"forcebound/control", "forcebound/time", "forcebound/net", "forcebound/record", "forcebound/security",
      "forcebound/device", "forcebound/server/environment", "forcebound/server/follower", "forcebound/server/security",
      "forcebound/server/session"}},
    {"forcebound/server/app",
     {"forcebound/control", "forcebound/http", "forcebound/page", "forcebound/program", "forcebound/text",
      "forcebound/time", "forcebound/wire", "forcebound/net", "forcebound/record", "forcebound/scene",
      "forcebound/security", "forcebound/server", "forcebound/view"}},
    {"tests/tools/netem", {"forcebound/net", "forcebound/text", "forcebound/time"}},
    {"tests/tools/relay",
     {"forcebound/net", "forcebound/program", "forcebound/text", "forcebound/time", "tests/tools/netem"}},
    {"tests/tools/sim", {"forcebound", "tests/tools/netem"}},
    {"tests/tools/reference", {"forcebound/control"}},
    {"tests/tools/lab/figures", {"forcebound"}},
    {"tests/tools/lab/trials", {"forcebound", "tests/tools/data", "tests/tools/sim"}},
    {"tests/tools/lab/identification", {"forcebound", "tests/tools/sim"}},
    {"tests/tools/demo", {"forcebound", "tests/tools/lab/trials"}},
    {"tests/tools/lab/accuracy",
     {"forcebound", "tests/tools/netem", "tests/tools/sim", "tests/tools/lab/trials", "tests/tools/lab/figures"}},
    {"tests/tools/lab/comparison",
     {"forcebound", "tests/tools/data", "tests/tools/sim", "tests/tools/lab/trials", "tests/tools/lab/figures",
      "tests/tools/lab/accuracy"}},
    {"tests/tools/lab/teleoperation",
     {"forcebound", "tests/tools/sim", "tests/tools/lab/trials", "tests/tools/lab/figures",
      "tests/tools/lab/comparison"}},
    {"tests/tools/lab/rendering",
     {"forcebound", "tests/tools/sim", "tests/tools/lab/trials", "tests/tools/lab/figures", "tests/tools/lab/accuracy",
      "tests/tools/lab/comparison"}},
    {"tests/tools/lab/bench", {"forcebound", "tests/tools/lab/trials"}},
    {"tests/tools/lab/fleet", {"forcebound", "tests/tools/netem"}},
    {"tests/tools/lab/soak", {"forcebound", "tests/tools/reference", "tests/tools/sim"}},
    {"tests/tools/lab", {"forcebound", "tests/tools"}},
    {"tests/tools", {"forcebound"}},
    {"tests/consumer", {"forcebound"}},
    {"tests", {"forcebound", "tests"}},
};

// Programs, and code that runs the core on threads and sockets. Tests may too, except for the tools that ship.
constexpr std::string_view kShells =
    R"((client|server)/forcebound/(client|server)/(app|commands|runtime)/.*|client/(drivers|python)/.*|)"
    R"(common/forcebound/program/.*|tests/tools/(demo|relay|lab)/.*|tests/(?!tools/).*)";
constexpr std::string_view kShellsInWords =
    "the folders app, commands, runtime and common/forcebound/program, client/drivers, client/python, "
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
      R"(server/forcebound/server/security/moved_keys\.hpp|)"
      R"(common/forcebound/net/(name_lookup\.cpp|peer_link\.hpp))",
      kCrash, kChild},
     "common/forcebound/time/real_time.cpp, common/forcebound/record/idle_thread.hpp, which measures one, the "
     "client's scene_builder.hpp and handshaker.hpp, whose counts "
     "and texts another thread reads, the client's live_page.hpp, which two threads use, "
     "the server's shared_limits.hpp, moved_keys.hpp and scene_library.cpp, which all workers share, "
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
      R"(common/forcebound/record/idle_thread\.cpp)",
      kCrash, kChild},
     "common/forcebound/time's steady_clock, periodic_timer and real_time, common/forcebound/record/idle_thread.cpp, "
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
      R"(tests/(?!tools/).*)"},
     "common/forcebound/control/classic_text.hpp and common/forcebound/text/classic_locale.cpp, which take the "
     "classic "
     "one, common/forcebound/program/command_line.cpp, which writes no number, and the tests"},
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

/// The file's path as used in includes.
std::string_view include_path_of(std::string_view file) {
  for (const std::string_view root : {"common/", "client/", "server/"}) {
    if (file.starts_with(root)) return file.substr(root.size());
  }
  return file;
}

bool is_below(std::string_view path, std::string_view folder) {
  return path.starts_with(folder) && path.size() > folder.size() && path[folder.size()] == '/';
}

/// The innermost folder with a rule; null: there is none.
const Folder* folder_of(std::string_view file) {
  const std::string_view path = include_path_of(file);
  const Folder* innermost = nullptr;
  for (const Folder& folder : kFolders) {
    if (is_below(path, folder.path) && (innermost == nullptr || folder.path.size() > innermost->path.size())) {
      innermost = &folder;
    }
  }
  return innermost;
}

std::string without_comment(const std::string& line) { return line.substr(0, line.find("//")); }

std::optional<std::string> included(const std::string& code) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::smatch match;
  if (!std::regex_search(code, match, kInclude)) return std::nullopt;
  return match[1].str();
}

std::optional<std::string> wrong_include(const Folder& here, const std::string& header) {
  const bool ours = header.starts_with("forcebound/") || header.starts_with("tests/");
  if (here.path == "forcebound/control" && !ours && !header.starts_with("Eigen/") &&
      header.find_first_of("/.") != std::string::npos) {
    return "'" + header + "' is neither of the standard library nor Eigen's, which is all that control may know";
  }
  if (!ours || header.ends_with(".pb.h")) return std::nullopt;
  const auto holds = [&](std::string_view folder) { return is_below(header, folder); };
  if (holds(here.path) || std::ranges::any_of(here.knows(), holds)) return std::nullopt;
  std::string accepted(here.path);
  for (const auto known : here.knows()) accepted += ", " + std::string(known);
  return std::string(here.path) + " must not include '" + header + "', only what lies below " + accepted;
}

constexpr std::string_view kOurs = "forcebound";

/// The top-level folder that a folder of the rule lies in.
std::string_view page_of(std::string_view folder) {
  for (const std::string_view side : {"client", "server"}) {
    if (is_below(folder, kOurs) && folder.substr(kOurs.size() + 1).starts_with(side)) return side;
  }
  if (folder == "drivers" || folder == "python") return "client";
  return folder.starts_with(kOurs) ? "common" : "tests";
}

/// A folder's name on a page, without what every folder there begins with: "`scene/effects`".
std::string name_on(std::string_view page, std::string_view folder) {
  if (is_below(folder, kOurs)) folder.remove_prefix(kOurs.size() + 1);
  if (is_below(folder, page)) folder.remove_prefix(page.size() + 1);
  return "`" + std::string(folder) + "`";
}

/// "`session`, `common`'s `net` `time`".
std::string known_on(std::string_view page, const std::vector<std::string_view>& folders) {
  std::string all;
  std::map<std::string_view, std::string> names;  // by the page that they are on

  const auto add = [](std::string& list, const std::string& name, const char* between) {
    if (!list.empty()) list += between;
    list += name;
  };
  for (const std::string_view folder : folders) {
    const std::string whole = "`" + std::string(page) + "`";
    if (folder == kOurs) {
      add(all, "`common`, `client`, `server`", ", ");
    } else if (name_on(page, folder) == whole) {
      add(all, "all of " + whole, ", ");
    } else {
      add(names[page_of(folder)], name_on(page_of(folder), folder), " ");
    }
  }
  std::string text = all;
  if (!names[page].empty()) add(text, names[page], ", ");
  for (const auto& [side, of_side] : names) {
    if (side != page) add(text, "`" + std::string(side) + "`'s " + of_side, ", ");
  }
  return text.empty() ? "nothing else of ours" : text;
}

}  // namespace

std::string include_table(std::string_view page) {
  std::string table = "| folder | may include |\n| --- | --- |\n";
  for (const Folder& folder : kFolders) {
    if (page_of(folder.path) != page) continue;
    table += "| " + (folder.path == page ? "all others" : name_on(page, folder.path)) + " | ";
    table += known_on(page, folder.knows()) + " |\n";
  }
  return table;
}

std::string privilege_table() {
  std::string table = "| what | where |\n| --- | --- |\n";
  for (const Privilege& privilege : kPrivileges) {
    table += "| " + std::string(privilege.name) + " | " + std::string(privilege.owner) + " |\n";
  }
  return table;
}

std::string to_string(const Violation& violation) {
  return violation.file + ":" + std::to_string(violation.line) + ": " + violation.what;
}

std::vector<Violation> violations(std::string_view file, std::string_view text) {
  std::vector<Violation> found;
  const Folder* here = folder_of(file);
  if (here == nullptr) {
    found.push_back({std::string(file), 1, "no rule says whom this folder may include: add it to the include rule"});
    return found;
  }
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string code = without_comment(line);
    if (const auto header = included(code)) {
      if (const auto what = wrong_include(*here, *header)) found.push_back({std::string(file), number, *what});
    }
    for (const ReadyPrivilege& privilege : privileges()) {
      if (!std::regex_search(code, privilege.pattern)) continue;
      const auto holds = [&](const std::regex& where) { return std::regex_match(file.begin(), file.end(), where); };
      if (std::ranges::any_of(privilege.where, holds)) continue;
      found.push_back(
          {std::string(file), number,
           "'" + code + "': " + std::string(privilege.is.name) + " belong only to " + std::string(privilege.is.owner)});
    }
  }
  return found;
}

}  // namespace forcebound::architecture

#include "tests/architecture/include_rule.hpp"

#include <algorithm>
#include <optional>
#include <regex>
#include <span>
#include <sstream>

namespace forcebound::architecture {
namespace {

struct Concept {
  std::string_view folder;
  std::vector<std::string_view> knows;  // beside itself, by the folder in an include: "forcebound/<this>/x.hpp"
};

const std::vector<Concept>& concepts() {
  static const std::vector<Concept> kConcepts{
      {"common/control", {}},
      {"common/text", {}},
      {"common/time", {}},
      {"common/wire", {"control", "time"}},
      {"common/net", {"text", "time"}},
      {"common/record", {"control", "time", "wire"}},
      {"client/device", {"control", "text", "time"}},
      {"client/session", {"control", "text", "time", "wire", "net", "record", "client/device"}},
      {"client/app", {"control", "time", "wire", "net", "record", "client/device", "client/session"}},
      {"server/geometry", {"text"}},
      {"server/effects", {"control", "text", "server/geometry"}},
      {"server/tissue", {"text", "server/geometry", "server/effects"}},
      {"server/bodies", {"text", "server/geometry", "server/effects"}},
      {"server/scene",
       {"control", "text", "time", "server/geometry", "server/effects", "server/tissue", "server/bodies"}},
      {"server/session", {"control", "text", "time", "wire", "net", "server/scene"}},
      {"server/app",
       {"control", "text", "time", "wire", "net", "record", "server/effects", "server/scene", "server/session"}},
  };
  return kConcepts;
}

// What only some files may have. `where` is matched against the path, `pattern` against a line without its comment.
struct Privilege {
  std::string_view name;
  std::regex pattern;
  std::regex where;
  std::string_view owner;
};

const std::vector<Privilege>& privileges() {
  static const std::vector<Privilege> kPrivileges{
      {"Asio", std::regex(R"(#include\s*[<"]asio)"), std::regex("common/net/(internal/)?udp.*|(client|server)/app/.*"),
       "common/net/udp* and */app"},
      {"generated Protocol Buffers code", std::regex(R"(#include\s*[<"].*\.pb\.h[">])"),
       std::regex(R"(common/(wire|record)/.*\.cpp)"), "the .cpp files of common/wire and common/record"},
      {"logging", std::regex(R"(#include\s*[<"]spdlog/)"), std::regex("(client|server)/app/.*"), "*/app"},
      {"command lines", std::regex(R"(#include\s*[<"]CLI/)"), std::regex("(client|server)/app/.*"), "*/app"},
      {"threads",
       std::regex(
           R"(#include\s*<(thread|future|mutex|shared_mutex|condition_variable|semaphore|latch|barrier|stop_token|)"
           R"(pthread\.h)>|std::(jthread|thread|async)\b)"),
       std::regex("common/time/real_time\\.cpp|(client|server)/app/.*"), "common/time/real_time.cpp and */app"},
      {"sockets", std::regex(R"(#include\s*<(sys/socket|sys/epoll|poll|netdb|netinet/.*)(\.h)?>)"),
       std::regex("common/net/(internal/)?udp.*|(client|server)/app/.*"), "common/net/udp* and */app"},
      {"the system's clock",
       std::regex(
           R"((system|steady|high_resolution)_clock\b|\bclock_(gettime|nanosleep)\b|\bgettimeofday\b|)"
           R"(\bnanosleep\b|std::this_thread|#include\s*"forcebound/time/(steady_clock|periodic_timer|real_time))"),
       std::regex(
           R"(common/net/(internal/)?udp.*|common/time/(steady_clock|periodic_timer|real_time)\.[ch]pp|(client|server)/app/.*)"),
       "common/time's steady_clock, periodic_timer and real_time, and */app"},
      {"random numbers without a seed of ours",
       std::regex(R"(\bstd::random_device\b|\b(std::)?s?rand\(|\bgetrandom\()"), std::regex("(client|server)/app/.*"),
       "*/app, which draws a seed once and prints it"},
  };
  return kPrivileges;
}

std::string_view folder_in_includes(const Concept& one) {
  constexpr std::string_view kCommon = "common/";
  return one.folder.starts_with(kCommon) ? one.folder.substr(kCommon.size()) : one.folder;
}

const Concept* concept_of(std::string_view file) {
  const auto found = std::ranges::find_if(
      concepts(), [&](const Concept& one) { return file.starts_with(std::string(one.folder) + "/"); });
  return found == concepts().end() ? nullptr : &*found;
}

std::string without_comment(const std::string& line) { return line.substr(0, line.find("//")); }

std::optional<std::string> included(const std::string& code) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::smatch match;
  if (!std::regex_search(code, match, kInclude)) return std::nullopt;
  return match[1].str();
}

std::optional<std::string> wrong_include(const Concept& includer, const std::string& header) {
  if (header.starts_with("tests/")) return "'" + header + "' is test code, which nothing but tests may include";
  if (includer.folder == "common/control" && !header.starts_with("forcebound/") &&
      header.starts_with("Eigen/") == false && header.find_first_of("/.") != std::string::npos) {
    return "'" + header + "' is neither of the standard library nor Eigen's, which is all that control may know";
  }
  constexpr std::string_view kOurs = "forcebound/";
  if (!header.starts_with(kOurs) || header.ends_with(".pb.h")) return std::nullopt;
  const std::string_view path = std::string_view(header).substr(kOurs.size());
  const std::string_view folder = path.substr(0, path.rfind('/'));
  const auto is_in = [&](std::string_view known) {
    return folder == known || folder.starts_with(std::string(known) + "/");
  };
  if (is_in(folder_in_includes(includer)) || std::ranges::any_of(includer.knows, is_in)) return std::nullopt;
  std::string accepted(folder_in_includes(includer));
  for (const auto known : includer.knows) accepted += ", " + std::string(known);
  return std::string(includer.folder) + " must not include '" + header + "', only " + accepted;
}

}  // namespace

std::string to_string(const Violation& violation) {
  return violation.file + ":" + std::to_string(violation.line) + ": " + violation.what;
}

std::vector<Violation> violations(std::string_view file, std::string_view text) {
  std::vector<Violation> found;
  const Concept* here = concept_of(file);
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
    for (const auto& privilege : privileges()) {
      if (!std::regex_search(code, privilege.pattern)) continue;
      if (std::regex_match(file.begin(), file.end(), privilege.where)) continue;
      found.push_back(
          {std::string(file), number,
           "'" + code + "': " + std::string(privilege.name) + " belong only to " + std::string(privilege.owner)});
    }
  }
  return found;
}

}  // namespace forcebound::architecture

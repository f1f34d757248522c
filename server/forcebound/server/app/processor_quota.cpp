#include "forcebound/server/app/processor_quota.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

namespace fs = std::filesystem;

/// The words in a file; none if there is none.
std::string words_in(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// "QUOTA PERIOD", in microseconds; a quota that is "max", or negative, is none.
std::optional<double> share(const std::string& text) {
  const std::vector<std::string_view> words = text::split_at_blanks(text);
  if (words.size() != 2) return std::nullopt;
  const double quota_us = text::finite_number(words[0]).value_or(0);
  const double period_us = text::finite_number(words[1]).value_or(0);
  if (quota_us <= 0 || period_us <= 0) return std::nullopt;
  return quota_us / period_us;
}

std::optional<double> share_of(const fs::path& group) {
  if (const std::string both = words_in(group / "cpu.max"); !both.empty()) return share(both);
  return share(words_in(group / "cpu.cfs_quota_us") + " " + words_in(group / "cpu.cfs_period_us"));
}

bool names_cpu(const std::string& controllers) { return ("," + controllers + ",").find(",cpu,") != std::string::npos; }

}  // namespace

std::optional<double> processor_quota(const fs::path& own, const fs::path& groups) {
  std::optional<double> least;
  std::ifstream lines(own);
  // NUMBER:CONTROLLERS:PATH; without controllers it is the newer hierarchy, which may be mounted beside older ones.
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    if (!controllers.empty() && !names_cpu(controllers)) continue;
    fs::path hierarchy = groups / (controllers.empty() ? "unified" : controllers);
    std::error_code unreadable;
    if (!fs::is_directory(hierarchy, unreadable)) hierarchy = controllers.empty() ? groups : groups / "cpu";
    // What is mounted may begin at the process's own group, whose path then does not exist in it.
    fs::path group = fs::path(line.substr(second + 1)).relative_path();
    for (bool more = true; more; group = group.parent_path()) {
      more = !group.empty();
      if (const auto here = share_of(hierarchy / group)) least = std::min(least.value_or(*here), *here);
    }
  }
  return least;
}

}  // namespace forcebound::server

#include "tests/architecture/source_text.hpp"

#include <regex>
#include <sstream>

namespace forcebound::architecture {

std::string_view include_path_of(std::string_view file) {
  for (const std::string_view root : {"common/", "client/", "server/"}) {
    if (file.starts_with(root)) return file.substr(root.size());
  }
  return file;
}

bool is_below(std::string_view path, std::string_view folder) {
  return path.starts_with(folder) && path.size() > folder.size() && path[folder.size()] == '/';
}

void for_each_line(std::string_view text, const std::function<void(int number, const std::string& code)>& use) {
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) use(number, line.substr(0, line.find("//")));
}

std::optional<std::string> included(const std::string& code) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  if (code.find("include") == std::string::npos) return std::nullopt;  // sooner told than by the expression
  std::smatch match;
  if (!std::regex_search(code, match, kInclude)) return std::nullopt;
  return match[1].str();
}

}  // namespace forcebound::architecture

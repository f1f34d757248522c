#include "tests/architecture/include_rule.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "tests/architecture/source_text.hpp"

namespace forcebound::architecture {
namespace {

/// A folder, by the path prefix of includes of its headers, and the folders whose headers it may include, with all
/// below them.
struct Folder {
  std::string path;
  std::vector<std::string> known{};
};

const std::vector<Folder>& folders() {
  static const std::vector<Folder> kFolders = [] {
    std::vector<Folder> all;
    std::istringstream lines{std::string(declared_rule().front().text)};
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      Folder& folder = all.emplace_back();
      words >> folder.path;
      folder.path.pop_back();  // the colon
      for (std::string known; words >> known;) folder.known.push_back(known);
    }
    return all;
  }();
  return kFolders;
}

/// The innermost folder with a rule; null: there is none.
const Folder* folder_of(std::string_view file) {
  const std::string_view path = include_path_of(file);
  const Folder* innermost = nullptr;
  for (const Folder& folder : folders()) {
    if (is_below(path, folder.path) && (innermost == nullptr || folder.path.size() > innermost->path.size())) {
      innermost = &folder;
    }
  }
  return innermost;
}

constexpr std::string_view kOurs = "forcebound";

std::optional<std::string> wrong_include(const Folder& here, const std::string& header) {
  const bool ours = is_below(header, kOurs) || is_below(header, "tests");
  if (here.path == "forcebound/control" && !ours && !header.starts_with("Eigen/") &&
      header.find_first_of("/.") != std::string::npos) {
    return "'" + header + "' is neither of the standard library nor Eigen's, which is all that control may know";
  }
  const auto holds = [&](std::string_view folder) { return is_below(header, folder); };
  if (!ours || holds(here.path) || std::ranges::any_of(here.known, holds)) return std::nullopt;
  std::string accepted = here.path;
  for (const std::string& known : here.known) accepted += ", " + known;
  return here.path + " must not include '" + header + "', only what lies below " + accepted;
}

/// The top-level folder that a folder of the rule lies in.
std::string_view page_of(std::string_view folder) {
  for (const std::string_view side : {"client", "server"}) {
    if (is_below(folder, kOurs) && folder.substr(kOurs.size() + 1).starts_with(side)) return side;
  }
  if (folder == "drivers" || folder == "library" || folder == "python") return "client";
  if (folder == "forcebound/v1") return "proto";
  return folder.starts_with(kOurs) ? "common" : "tests";
}

/// A folder's name on a page, without what every folder there begins with: "`scene/effects`".
std::string name_on(std::string_view page, std::string_view folder) {
  if (is_below(folder, kOurs)) folder.remove_prefix(kOurs.size() + 1);
  if (is_below(folder, page)) folder.remove_prefix(page.size() + 1);
  return "`" + std::string(folder) + "`";
}

/// "`session`, `common`'s `net` `time`".
std::string known_on(std::string_view page, const std::vector<std::string>& folders) {
  std::string text;
  std::map<std::string_view, std::string> names;  // by the page that they are on

  const auto add = [](std::string& list, const std::string& name, const char* between) {
    if (!list.empty()) list += between;
    list += name;
  };
  for (const std::string& folder : folders) {
    if (folder == kOurs) {
      add(text, "`common`, `client`, `server`", ", ");
    } else {
      add(names[page_of(folder)], name_on(page_of(folder), folder), " ");
    }
  }
  if (!names[page].empty()) add(text, names[page], ", ");
  for (const auto& [side, of_side] : names) {
    if (side != page) add(text, "`" + std::string(side) + "`'s " + of_side, ", ");
  }
  return text.empty() ? "nothing else of ours" : text;
}

/// Such folders may include each other.
bool one_is_within_the_other(std::string_view one, std::string_view other) {
  return is_below(one, other) || is_below(other, one);
}

/// Adds what a folder may include, and what that may, and so on.
void add_reached(std::string_view path, std::set<std::string>& reached) {
  for (const Folder& folder : folders()) {
    if (folder.path != path) continue;
    for (const std::string& known : folder.known) {
      if (!one_is_within_the_other(known, path) && reached.insert(known).second) add_reached(known, reached);
    }
  }
}

/// What a folder may include, without what follows from others of it.
std::vector<std::string> without_followers(const Folder& here) {
  std::set<std::string> following;
  for (const std::string& known : here.known) {
    if (!one_is_within_the_other(known, here.path)) add_reached(known, following);
  }
  std::vector<std::string> left;
  std::ranges::copy_if(here.known, std::back_inserter(left),
                       [&](const std::string& known) { return !following.contains(known); });
  return left;
}

}  // namespace

std::string include_table(std::string_view page) {
  std::string table = "| folder | may include |\n| --- | --- |\n";
  for (const Folder& folder : folders()) {
    if (page_of(folder.path) != page) continue;
    table += "| " + (folder.path == page ? "all others" : name_on(page, folder.path)) + " | ";
    table += known_on(page, without_followers(folder)) + " |\n";
  }
  return table;
}

std::vector<Violation> include_violations(std::string_view file, std::string_view text) {
  std::vector<Violation> found;
  const Folder* here = folder_of(file);
  if (here == nullptr) {
    found.push_back({std::string(file), 1,
                     "no rule says whom this folder may include: declare it in CMake, by forcebound_library, "
                     "forcebound_program or forcebound_may_include"});
    return found;
  }
  for_each_line(text, [&](int number, const std::string& code) {
    const auto header = included(code);
    if (!header) return;
    if (const auto what = wrong_include(*here, *header)) found.push_back({std::string(file), number, *what});
  });
  return found;
}

}  // namespace forcebound::architecture

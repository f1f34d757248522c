#pragma once

#include <string>
#include <string_view>
#include <vector>

/// The rule of who may include whom, and of which code may touch the operating system.
namespace forcebound::architecture {

struct Violation {
  std::string file;  ///< relative to the source root
  int line = 0;
  std::string what;  ///< the offending text and what would be accepted
};

std::string to_string(const Violation& violation);

/// All violations in one source file.
///
/// @param file path relative to the source root, with '/': decides which rules hold for `text`.
/// A file in a folder of common, client or server that no rule names is a violation as well: a new folder needs a rule
/// first.
std::vector<Violation> violations(std::string_view file, std::string_view text);

/// The folders below `common`, `client`, `server` or `tests` and what each may include beside its own headers, as a
/// table in Markdown.
std::string include_table(std::string_view page);

/// What only some files may have, and which, as a table in Markdown.
std::string privilege_table();

}  // namespace forcebound::architecture

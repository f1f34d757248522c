#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/text/embedded_text.hpp"
#include "tests/architecture/violation.hpp"

/// The rule of who may include whom. CMake declares it: a folder may include what its library links, and what
/// forcebound_may_include (deploy/cmake/ForceboundTargets.cmake) says.
namespace forcebound::architecture {

/// What CMake has written, a line for each folder: "forcebound/net: forcebound/time".
std::span<const text::EmbeddedText> declared_rule() noexcept;

/// The includes of one source file that the rule does not allow.
///
/// @param file path relative to the source root, with '/': decides which line of the rule holds for `text`.
/// A file in a folder of which the rule says nothing is a violation as well.
std::vector<Violation> include_violations(std::string_view file, std::string_view text);

/// The folders below `common`, `client`, `server` or `tests` and what each may include beside its own headers, as a
/// table in Markdown, without what follows from others: where A includes B and B includes C, A's own includes of C.
std::string include_table(std::string_view page);

}  // namespace forcebound::architecture

#pragma once

#include <string>
#include <string_view>

namespace forcebound::text {

/// The lines around text that a program writes into a document.
struct Marks {
  std::string_view begin;
  std::string_view end;
};

/// The text between the two marks of a document. @throws std::runtime_error unless it has each once
[[nodiscard]] std::string_view between_marks(std::string_view document, const Marks& marks);

/// The document with that part replaced.
[[nodiscard]] std::string with_between_marks(std::string_view document, const Marks& marks, std::string_view part);

}  // namespace forcebound::text

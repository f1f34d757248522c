#pragma once

#include <string>
#include <string_view>

namespace forcebound::lab {

/// The lines around what a program writes into a document.
struct Marks {
  std::string_view begin;
  std::string_view end;
};

/// What a document has between the two marks. @throws std::runtime_error if it has not both, once each
[[nodiscard]] std::string_view between_marks(std::string_view document, const Marks& marks);

/// The document with that part replaced.
[[nodiscard]] std::string with_between_marks(std::string_view document, const Marks& marks, std::string_view part);

}  // namespace forcebound::lab

#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace forcebound::text {

/// A text file that was built into a library (deploy/cmake/EmbedTexts.cmake).
struct EmbeddedText {
  std::string_view name;  ///< the file's, without folder and extension
  std::string_view text;
};

/// The text of the file of that name. @throws std::logic_error if it was not built in
[[nodiscard]] inline std::string_view text_of(std::span<const EmbeddedText> files, std::string_view name) {
  const auto file = std::ranges::find(files, name, &EmbeddedText::name);
  if (file == files.end()) throw std::logic_error("no file '" + std::string(name) + "' is built in");
  return file->text;
}

}  // namespace forcebound::text

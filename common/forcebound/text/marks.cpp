#include "forcebound/text/marks.hpp"

#include <stdexcept>

namespace forcebound::text {

std::string_view between_marks(std::string_view document, const Marks& marks) {
  const std::size_t begin = document.find(marks.begin);
  const std::size_t end = document.find(marks.end);
  const bool once = begin != std::string_view::npos && end != std::string_view::npos && begin < end &&
                    document.find(marks.begin, begin + 1) == std::string_view::npos &&
                    document.find(marks.end, end + 1) == std::string_view::npos;
  if (!once) {
    throw std::runtime_error("expected once each, on lines of their own: '" +
                             std::string(marks.begin.substr(0, marks.begin.size() - 1)) + "' and '" +
                             std::string(marks.end.substr(0, marks.end.size() - 1)) + "'");
  }
  return document.substr(begin + marks.begin.size(), end - begin - marks.begin.size());
}

std::string with_between_marks(std::string_view document, const Marks& marks, std::string_view part) {
  const std::string_view before = between_marks(document, marks);
  const auto at = static_cast<std::size_t>(before.data() - document.data());
  return std::string(document.substr(0, at)) + std::string(part) + std::string(document.substr(at + before.size()));
}

}  // namespace forcebound::text

#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace forcebound::server {

/// Counts in words, a line for each subject: "motions: 20 received, 3 reordered". Of a subject the first is told
/// always, the others where they are not zero.
class CountText {
 public:
  void add(std::string_view subject, std::uint64_t count, std::string_view words) {
    const bool first = subject != subject_;
    if (!first && count == 0) return;
    if (first && !text_.empty()) text_ += '\n';
    text_ += (first ? std::string(subject) + ": " : std::string(", ")) + std::to_string(count) + ' ';
    text_ += words;
    subject_ = subject;
  }

  [[nodiscard]] std::string text() const { return text_ + '\n'; }

 private:
  std::string text_;
  std::string_view subject_;
};

}  // namespace forcebound::server

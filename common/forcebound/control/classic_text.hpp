#pragma once

#include <locale>
#include <sstream>
#include <string>

namespace forcebound::control {

/// A text to write to, as std::ostringstream, with numbers as the files have them, "0.001", whatever the process's
/// locale: a driver or a program around may have chosen one with a comma.
class ClassicText : public std::ostringstream {
 public:
  ClassicText() { imbue(std::locale::classic()); }
};

/// The parts as one such text.
template <class... Parts>
[[nodiscard]] std::string joined(const Parts&... parts) {
  ClassicText text;
  (text << ... << parts);
  return text.str();
}

}  // namespace forcebound::control

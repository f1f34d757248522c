#pragma once

#include <string>
#include <string_view>

#include "tests/tools/relay/relay.hpp"

namespace forcebound::relay {

/// Changes the impairments of a relay while it runs, by lines of text:
///
///     both delay 50ms loss 5%     both directions from now on, in netem's words; `up` and `down` are one of them
///     down                        without words: a perfect network
///     status                      changes nothing
///
/// Each line is answered by the impairments that now hold, "up: delay 50ms; down: perfect", or by "error: " and what
/// would be accepted, in which case nothing has changed. Not thread-safe.
class Control {
 public:
  /// The impairments of both directions, in the words they were given in.
  struct Words {
    std::string up;
    std::string down;
  };

  struct Answer {
    std::string text;      ///< one line
    bool changed = false;  ///< whether other impairments hold now
  };

  /// @param relay must outlive it. @param words of the impairments that the relay has now
  Control(Relay& relay, Words words) : relay_(relay), words_(std::move(words)) {}

  Answer answer(std::string_view line, Nanoseconds now);

 private:
  [[nodiscard]] std::string status() const;

  Relay& relay_;
  Words words_;
};

}  // namespace forcebound::relay

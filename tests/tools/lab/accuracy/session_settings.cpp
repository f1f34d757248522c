#include "tests/tools/lab/accuracy/session_settings.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::lab {
namespace {

/// Without the quotes that TOML wants.
std::string unquoted(const std::string& name) {
  const bool quoted = name.size() >= 2 && (name.front() == '"' || name.front() == '\'') && name.back() == name.front();
  return quoted ? name.substr(1, name.size() - 2) : name;
}

bool renders_locally(const std::string& name) {
  const std::vector<std::string> known{"local", "remote"};
  if (name == known.front()) return true;
  if (name == known.back()) return false;
  throw std::invalid_argument("unknown rendering '" + name + "'" + text::suggestion(name, known));
}

enum class Least : std::uint8_t { zero, above_zero };

double number(const std::string& key, const std::string& value, Least least) {
  const auto read = text::finite_number(value);
  const bool above = least == Least::above_zero;
  if (read && (above ? *read > 0 : *read >= 0)) return *read;
  throw std::invalid_argument(key + " must be a number " + (above ? "> 0" : ">= 0") + ", got '" + value + "'");
}

time::Nanoseconds milliseconds_of(const std::string& key, const std::string& value) {
  return time::from_seconds(1e-3 * number(key, value, Least::zero));
}

std::string ms(time::Nanoseconds time) { return text::rounded(1e3 * time::to_seconds(time)) + " ms"; }

}  // namespace

const std::vector<std::string>& session_keys() {
  static const std::vector<std::string> kKeys{"law", "hold_ms", "drop_ms", "rate_Hz", "rendering"};
  return kKeys;
}

bool is_session_key(std::string_view key) { return std::ranges::find(session_keys(), key) != session_keys().end(); }

SessionSettings with_session_key(SessionSettings session, const std::string& key, const std::string& value) {
  if (key == "law") {
    session.law = law_plugin::law_named(unquoted(value));
  } else if (key == "hold_ms") {
    session.policy.hold = milliseconds_of(key, value);
  } else if (key == "drop_ms") {
    session.policy.drop = milliseconds_of(key, value);
  } else if (key == "rate_Hz") {
    session.server_rate_Hz = number(key, value, Least::above_zero);
  } else if (key == "rendering") {
    session.renders_locally = renders_locally(unquoted(value));
  } else {
    throw std::invalid_argument("a session has no '" + key + "'" + text::suggestion(key, session_keys()));
  }
  session.policy.validate();
  return session;
}

std::string to_text(const SessionSettings& session) {
  return "law " + session.law + ", hold " + ms(session.policy.hold) + ", drop " + ms(session.policy.drop) +
         ", the server answers at most " + text::rounded(session.server_rate_Hz) + " motions a second, rendering " +
         (session.renders_locally ? "local" : "remote");
}

}  // namespace forcebound::lab

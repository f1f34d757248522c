#pragma once

namespace forcebound::page {

/// A member of a JSON object, null where it has none or is no object. Never a copy: what came from elsewhere may be
/// nested so deeply that a copy takes all of the stack.
template <class Json>
[[nodiscard]] const Json& json_member(const Json& object, const char* key) {
  static const Json kNone;
  const auto found = object.find(key);
  return found == object.end() ? kNone : *found;
}

}  // namespace forcebound::page

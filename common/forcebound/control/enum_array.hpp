#pragma once

#include <array>
#include <cstddef>

namespace forcebound::control {

/// A value for each enumerator, whose numbers run from 0 to kSize - 1.
template <class Enum, class Value, std::size_t kSize>
struct EnumArray : std::array<Value, kSize> {
  using Numbered = std::array<Value, kSize>;

  [[nodiscard]] constexpr Value& operator[](Enum which) noexcept {
    return Numbered::operator[](static_cast<std::size_t>(which));
  }
  [[nodiscard]] constexpr const Value& operator[](Enum which) const noexcept {
    return Numbered::operator[](static_cast<std::size_t>(which));
  }

  constexpr EnumArray& operator+=(const EnumArray& other) noexcept {
    for (std::size_t i = 0; i < kSize; ++i) Numbered::operator[](i) += other.Numbered::operator[](i);
    return *this;
  }
};

/// Whether a table has a row for each enumerator, in their order. @param which of them a row is for
template <class Rows, class Row, class Enum>
[[nodiscard]] consteval bool is_in_order(const Rows& rows, Enum Row::*which) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (static_cast<std::size_t>(rows[i].*which) != i) return false;
  }
  return true;
}

}  // namespace forcebound::control

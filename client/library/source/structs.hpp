#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>

#include "library/source/errors.hpp"

namespace forcebound::library {

/// A text that a program gave; null: `otherwise`.
[[nodiscard]] inline std::string text_of(const char* text, const std::string& otherwise = {}) {
  return text == nullptr ? otherwise : text;
}

/// Gives a program a text with its zero, cut where there is no room for it.
/// @param to may be null if `bytes` is 0 @param needed of the whole text; may be null
[[nodiscard]] inline fb_status give_text(const char* function, std::string_view from, char* to, std::size_t bytes,
                                         std::size_t* needed) {
  if (to == nullptr && bytes > 0) return refused(function, "text is null, and bytes are not 0");
  if (needed != nullptr) *needed = from.size() + 1;
  if (bytes > 0) to[from.copy(to, bytes - 1)] = '\0';
  if (bytes > from.size()) return FB_OK;
  return refused(
      function,
      "the text has " + std::to_string(from.size() + 1) + " bytes with its zero, got room for " + std::to_string(bytes),
      FB_TOO_SMALL);
}

/// Copies text into a field of a struct, cut where it does not fit.
template <std::size_t kBytes>
void set_text(char (&field)[kBytes], std::string_view text) noexcept {
  const std::size_t fits = std::min(text.size(), kBytes - 1);
  std::copy_n(text.begin(), fits, field);
  field[fits] = '\0';
}

inline constexpr std::size_t kStructBytesMost = std::size_t{1} << 16U;  // beyond is no size but rubbish

[[nodiscard]] inline fb_status refused_null(const char* function, const char* name) noexcept {
  std::array<char, 256> why{};
  (void)std::snprintf(why.data(), why.size(), "%s is null", name);
  return refused(function, why.data());
}

/// A caller's struct is no such struct: "fb_motion.size is 3, accepted are 520 or more: set it by FB_INIT(fb_motion)".
[[nodiscard]] inline fb_status refused_size(const char* function, const char* name, std::size_t size,
                                            std::size_t least) noexcept {
  std::array<char, 256> why{};
  (void)std::snprintf(why.data(), why.size(), "%s.size is %zu, accepted are %zu or more: set it by FB_INIT(%s)", name,
                      size, least, name);
  return refused(function, why.data());
}

[[nodiscard]] inline fb_status refused_beyond(const char* function, const char* name, std::size_t size,
                                              std::size_t known) noexcept {
  std::array<char, 256> why{};
  (void)std::snprintf(why.data(), why.size(),
                      "%s of %zu bytes sets a field that this library, %s, does not know: accepted are its first %zu "
                      "bytes, and zeros",
                      name, size, FORCEBOUND_VERSION, known);
  return refused(function, why.data());
}

/// Whether a program's struct sets nothing that lies beyond the library's own.
template <class Struct>
[[nodiscard]] bool is_zero_beyond(const Struct& given) noexcept {
  const auto* const bytes = reinterpret_cast<const char*>(&given);  // NOLINT(*-reinterpret-cast)
  return std::all_of(bytes + sizeof(Struct), bytes + std::max(given.size, sizeof(Struct)),
                     [](char byte) { return byte == 0; });
}

/// A struct that a program gave, as the library knows it: the program's own where that is as large, else a copy with
/// zeros for what is not there. Noexcept, no allocation.
template <class Struct>
class Given {
 public:
  /// @param given may be null @param least bytes of it that must be there
  Given(const char* function, const char* name, const Struct* given, std::size_t least) noexcept {
    if (given == nullptr) {
      status_ = refused_null(function, name);
    } else if (given->size == sizeof(Struct)) {
      struct_ = given;
    } else if (given->size < least || given->size > kStructBytesMost) {
      status_ = refused_size(function, name, given->size, least);
    } else if (given->size < sizeof(Struct)) {
      copy_ = {};
      std::memcpy(&copy_, given, given->size);
      struct_ = &copy_;
    } else if (is_zero_beyond(*given)) {
      struct_ = given;
    } else {
      status_ = refused_beyond(function, name, given->size, sizeof(Struct));
    }
  }
  Given(const Given&) = delete;
  Given& operator=(const Given&) = delete;

  /// FB_OK, or what the function is to return.
  [[nodiscard]] fb_status status() const noexcept { return status_; }
  [[nodiscard]] const Struct& operator*() const noexcept { return *struct_; }
  [[nodiscard]] const Struct* operator->() const noexcept { return struct_; }

 private:
  fb_status status_ = FB_OK;
  const Struct* struct_ = nullptr;
  Struct copy_;  // set where it is used: a tick has no time for zeros
};

/// Gives `take` each struct of an array that a program gave. Its header may be another one: the distance from one to
/// the next is the size of the first. @returns FB_OK, or what the function is to return for one that is no such struct
template <class Struct, class Take>
[[nodiscard]] fb_status take_each(const char* function, const char* name, const Struct* first, std::size_t count,
                                  std::size_t least, const Take& take) {
  const auto* at = reinterpret_cast<const std::byte*>(first);  // NOLINT(*-reinterpret-cast)
  for (std::size_t i = 0; i < count; ++i, at += first->size) {
    const Given<Struct> given(function, name, reinterpret_cast<const Struct*>(at),  // NOLINT(*-reinterpret-cast)
                              least);
    if (given.status() != FB_OK) return given.status();
    take(*given);
  }
  return FB_OK;
}

/// FB_OK, or what the function is to return for a struct of the program that is no such struct.
template <class Struct>
[[nodiscard]] fb_status expect_size(const char* function, const char* name, const Struct& given,
                                    std::size_t least) noexcept {
  return given.size < least || given.size > kStructBytesMost ? refused_size(function, name, given.size, least) : FB_OK;
}

/// Gives a program a struct, no further than its size, with zeros for what the library does not know.
/// @param to may be null @param least bytes that must have room. Noexcept, no allocation.
template <class Struct>
[[nodiscard]] fb_status give(const char* function, const char* name, const Struct& from, Struct* to,
                             std::size_t least) noexcept {
  if (to == nullptr) return refused_null(function, name);
  if (const fb_status status = expect_size(function, name, *to, least); status != FB_OK) return status;
  const std::size_t size = to->size;
  std::memcpy(to, &from, std::min(size, sizeof(Struct)));
  if (size > sizeof(Struct)) std::memset(to + 1, 0, size - sizeof(Struct));
  to->size = size;
  return FB_OK;
}

}  // namespace forcebound::library

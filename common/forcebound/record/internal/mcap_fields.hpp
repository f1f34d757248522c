#pragma once

#include <concepts>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

/// The contents of MCAP records, taken apart. Private to this folder.
namespace forcebound::record::mcap {

/// A part of a file is not as it was written: "byte 17: what".
class Damage : public std::runtime_error {
 public:
  Damage(std::uint64_t byte, const std::string& what)
      : std::runtime_error("byte " + std::to_string(byte) + ": " + what) {}
};

/// CRC-32 of the bytes before, then these.
[[nodiscard]] std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before = 0) noexcept;

/// @throws Damage unless the bytes have the checksum that the file says; 0: it says none.
void expect_crc(std::uint32_t stated, std::string_view bytes, std::uint64_t offset, const char* what);

/// Takes a record's content apart. What does not fit in it is Damage.
class Fields {
 public:
  Fields(std::uint64_t offset, std::string_view content) : offset_(offset), rest_(content) {}

  template <std::unsigned_integral Number>
  Number number() {
    const std::string_view bytes = take(sizeof(Number));
    Number value = 0;
    for (std::size_t i = sizeof(Number); i-- > 0;) {
      value = static_cast<Number>((std::uint64_t{value} << 8U) | static_cast<unsigned char>(bytes[i]));
    }
    return value;
  }
  std::string_view text() { return take(number<std::uint32_t>()); }
  std::string_view take(std::uint64_t count) {
    if (count > rest_.size()) {
      throw Damage(offset_, "a field of " + std::to_string(count) + " bytes does not fit in the " +
                                std::to_string(rest_.size()) + " left of its record");
    }
    const std::string_view bytes = rest_.substr(0, count);
    rest_.remove_prefix(count);
    offset_ += count;
    return bytes;
  }
  std::map<std::string, std::string> map() {
    std::map<std::string, std::string> values;
    const std::uint64_t start = offset_ + sizeof(std::uint32_t);
    Fields entries(start, text());
    while (!entries.rest().empty()) {
      std::string key(entries.text());
      values[std::move(key)] = entries.text();
    }
    return values;
  }
  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] std::uint64_t offset() const { return offset_; }

 private:
  std::uint64_t offset_;
  std::string_view rest_;
};

}  // namespace forcebound::record::mcap

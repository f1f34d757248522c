#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

/// Messages in the encoding of DDS, XCDR1 in little endian, by hand: an independent check of what a library writes.
namespace forcebound::ros2_peer {

inline constexpr std::size_t kHeader = 4;
inline constexpr std::uint8_t kLittleEndian = 1;

/// Writes what it is called with, each number aligned to its size behind the header.
class CdrWriter {
 public:
  template <class Number>
  void operator()(const Number& number) {
    while ((bytes_.size() - kHeader) % sizeof number != 0) bytes_.push_back(0);
    const auto* const first = reinterpret_cast<const std::uint8_t*>(&number);
    bytes_.insert(bytes_.end(), first, first + sizeof number);
  }
  void operator()(const std::string& text) {
    (*this)(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
  }
  template <class Item>
  void operator()(const std::vector<Item>& items) {
    (*this)(static_cast<std::uint32_t>(items.size()));
    for (const Item& item : items) (*this)(item);
  }

  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_{0, kLittleEndian, 0, 0};
};

/// Reads likewise. @throws std::runtime_error where the bytes end too early, or are of another encoding
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    if (bytes.size() < kHeader || bytes[0] != 0 || bytes[1] != kLittleEndian) throw std::runtime_error("no XCDR1");
  }

  template <class Number>
  void operator()(Number& number) {
    while ((at_ - kHeader) % sizeof number != 0) ++at_;
    std::memcpy(&number, take(sizeof number), sizeof number);
  }
  void operator()(std::string& text) {
    std::uint32_t size = 0;
    (*this)(size);
    const auto* const first = reinterpret_cast<const char*>(take(size));
    text.assign(first, size > 0 ? size - 1 : 0);
  }
  template <class Item>
  void operator()(std::vector<Item>& items) {
    std::uint32_t size = 0;
    (*this)(size);
    items.clear();
    for (std::uint32_t i = 0; i < size; ++i) (*this)(items.emplace_back());
  }

 private:
  const std::uint8_t* take(std::size_t count) {
    if (at_ > bytes_.size() || bytes_.size() - at_ < count) throw std::runtime_error("a message is cut");
    at_ += count;
    return bytes_.data() + at_ - count;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = kHeader;
};

}  // namespace forcebound::ros2_peer

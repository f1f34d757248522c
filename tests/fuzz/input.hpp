#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include "tests/fuzz/targets.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::fuzz {

/// Something that must hold for any bytes does not. Nothing of ours catches it.
class Finding : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

inline void must(bool holds, const char* what) {
  if (!holds) throw Finding(what);
}

/// Runs what may refuse its input, as parsers document: by std::runtime_error or std::invalid_argument, with a text.
/// All other exceptions pass through: out of range, out of memory and the like are mistakes of ours.
template <class Work>
void may_refuse(Work&& work) {
  try {
    work();
  } catch (const std::system_error&) {
    throw;
  } catch (const std::runtime_error& error) {
    must(*error.what() != '\0', "a refusal without a word");
  } catch (const std::invalid_argument& error) {
    must(*error.what() != '\0', "a refusal without a word");
  }
}

[[nodiscard]] inline std::string_view text_of(Bytes bytes) {
  // Of an empty span the pointer may be null.
  return bytes.empty() ? std::string_view{}
                       : std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

/// One file in a folder of its own, for parsers that read files; removed with the program.
class InputFile {
 public:
  explicit InputFile(const std::string& name)
      : path_(folder_.file(name)), descriptor_(::open(path_.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600)) {
    if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), path_);
  }
  ~InputFile() { ::close(descriptor_); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  void replace(Bytes bytes) {
    if (::ftruncate(descriptor_, 0) != 0 ||
        ::pwrite(descriptor_, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
      throw std::system_error(errno, std::generic_category(), path_);
    }
  }

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::string folder() const { return folder_.path().string(); }

 private:
  test::TemporaryFolder folder_;
  std::string path_;
  int descriptor_;
};

/// Takes the bytes apart, for targets that are fed a script. At the end all is zero.
class Script {
 public:
  explicit Script(Bytes bytes) : rest_(bytes) {}

  [[nodiscard]] bool ended() const noexcept { return rest_.empty(); }

  /// As many bytes as there are, at most `count`.
  [[nodiscard]] Bytes take(std::size_t count) {
    const Bytes taken = rest_.first(std::min(count, rest_.size()));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }

  template <class Value>
  [[nodiscard]] Value value() {
    Value value{};
    const Bytes taken = take(sizeof value);
    if (!taken.empty()) std::memcpy(&value, taken.data(), taken.size());
    return value;
  }

  [[nodiscard]] std::uint8_t byte() { return value<std::uint8_t>(); }

 private:
  Bytes rest_;
};

}  // namespace forcebound::fuzz

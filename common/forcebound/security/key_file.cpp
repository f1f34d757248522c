#include "forcebound/security/key_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <span>
#include <system_error>
#include <vector>

#include "forcebound/config/config_error.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::security {
namespace {

constexpr std::string_view kSecret = "forcebound-secret-key";
constexpr std::string_view kShared = "forcebound-shared-key";
constexpr std::string_view kPublic = kPublicKeyWord;
constexpr std::size_t kKeyFileBytesMost = 4096;
constexpr ::mode_t kOwnerAlone = 0600;
constexpr ::mode_t kOthersPermissions = 0077;

struct KeyFileText {
  std::array<char, kKeyFileBytesMost + 1> characters{};
  std::size_t size = 0;
};

[[noreturn]] void refuse_key_file(const std::string& path, const std::string& why) {
  throw config::ConfigError(text::printable(path) + ": " + why);
}

std::string reason_of(int error) { return std::generic_category().message(error); }

class KeyDescriptor {
 public:
  KeyDescriptor(const std::string& path, int flags, ::mode_t mode)
      : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, mode)) {}
  ~KeyDescriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  KeyDescriptor(const KeyDescriptor&) = delete;
  KeyDescriptor& operator=(const KeyDescriptor&) = delete;
  [[nodiscard]] int get() const noexcept { return descriptor_; }

 private:
  int descriptor_;
};

std::string in_octal(::mode_t mode) {
  constexpr int kDigits = 3;
  constexpr unsigned kBits = 3;
  std::string text = "0";
  for (int digit = kDigits - 1; digit >= 0; --digit) {
    text += static_cast<char>('0' + (mode >> kBits * static_cast<unsigned>(digit) & 7U));
  }
  return text;
}

bool is_of_a_group_of_this_process(::gid_t group) {
  if (group == ::getegid()) return true;
  std::vector<::gid_t> groups(static_cast<std::size_t>(std::max(0, ::getgroups(0, nullptr))));
  const int count = ::getgroups(static_cast<int>(groups.size()), groups.data());
  groups.resize(static_cast<std::size_t>(std::max(0, count)));
  return std::ranges::find(groups, group) != groups.end();
}

/// Of the file that was opened, whatever is at its path by now.
void expect_secret(const struct ::stat& file, const std::string& path) {
  constexpr ::mode_t kPermissionBits = 0777;
  constexpr ::mode_t kGroupMayRead = 0040;
  const ::mode_t to_others = file.st_mode & kOthersPermissions;
  const bool given_by_root =
      to_others == kGroupMayRead && file.st_uid == 0 && is_of_a_group_of_this_process(file.st_gid);
  if (to_others != 0 && !given_by_root) {
    refuse_key_file(path, "others than its owner may use it (mode " + in_octal(file.st_mode & kPermissionBits) +
                              "), but it holds a secret; accepted is mode 0600: chmod 600, or a new key if others "
                              "may have seen this one; of a file of root also mode 0440, if its group is one of this "
                              "process's (it is of user " +
                              std::to_string(file.st_uid) + " and group " + std::to_string(file.st_gid) + ")");
  }
  if (file.st_uid != ::geteuid() && file.st_uid != 0) {
    refuse_key_file(path, "it belongs to user " + std::to_string(file.st_uid) +
                              ", but it holds a secret; accepted is a file of this user or of root");
  }
}

void read_key_file(const std::string& path, bool is_secret, KeyFileText& text) {
  // Not waiting for who writes to a pipe.
  const KeyDescriptor file(path, O_RDONLY | O_NONBLOCK, 0);
  if (file.get() < 0) refuse_key_file(path, "cannot be read: " + reason_of(errno));
  struct ::stat about {};
  if (::fstat(file.get(), &about) != 0) refuse_key_file(path, "cannot be read: " + reason_of(errno));
  if (!S_ISREG(about.st_mode)) refuse_key_file(path, "cannot be read: it is no regular file");
  if (is_secret) expect_secret(about, path);
  while (text.size < text.characters.size()) {
    const ssize_t bytes = ::read(file.get(), &text.characters[text.size], text.characters.size() - text.size);
    if (bytes == 0) return;
    if (bytes < 0 && errno != EINTR) refuse_key_file(path, "cannot be read: " + reason_of(errno));
    if (bytes > 0) text.size += static_cast<std::size_t>(bytes);
  }
  refuse_key_file(path, "it is longer than 4096 bytes, but a key file has one line with one key");
}

/// The one line that is no comment; empty if there is none, or more.
std::string_view only_line(std::string_view text) {
  std::string_view only;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text::trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line.starts_with('#')) continue;
    if (!only.empty()) return {};
    only = line;
  }
  return only;
}

/// What kind of key a line has; empty if it is none of ours.
std::string_view kind_of_line(std::string_view line) {
  for (const std::string_view kind : {kSecret, kShared, kPublic}) {
    if (line.starts_with(kind) && line.size() > kind.size() && line[kind.size()] == ' ') return kind;
  }
  return {};
}

/// The key in base64, in `text`. No part of the file is ever quoted: it might be a secret.
std::string_view key_in(const KeyFileText& text, std::string_view wanted, const std::string& path) {
  const std::string_view line = only_line({text.characters.data(), text.size});
  const std::string_view kind = kind_of_line(line);
  if (kind.empty()) {
    refuse_key_file(path, "it holds no key; accepted is one line '" + std::string(wanted) + " KEY', KEY in base64");
  }
  if (kind != wanted) {
    refuse_key_file(path, "it holds a " + std::string(kind) + ", but here a " + std::string(wanted) + " is wanted");
  }
  return text::trimmed(line.substr(kind.size()));
}

[[noreturn]] void refuse_key_text(const std::string& path, std::string_view wanted) {
  refuse_key_file(path, "its " + std::string(wanted) +
                            " is damaged; accepted are 44 characters of base64, as forcebound keygen writes them");
}

void read_secret(const std::string& path, std::string_view wanted, SecretKey& key) {
  Locked<KeyFileText> text;
  read_key_file(path, true, *text);
  if (!from_base64(key_in(*text, wanted, path), *key)) refuse_key_text(path, wanted);
}

void write_key_file(const std::string& path, std::string_view kind, const KeyBytes& key) {
  std::string text = to_base64(key);
  Locked<KeyFileText> line;
  for (const std::string_view part : {kind, std::string_view(" "), std::string_view(text), std::string_view("\n")}) {
    part.copy(&line->characters[line->size], part.size());
    line->size += part.size();
  }
  wipe(text.data(), text.size());

  const KeyDescriptor file(path, O_WRONLY | O_CREAT | O_EXCL, kOwnerAlone);
  if (file.get() < 0 && errno == EEXIST) {
    refuse_key_file(path,
                    "it is there already and is not replaced, since its key would be lost; accepted is a new "
                    "name, or remove it first");
  }
  if (file.get() < 0) refuse_key_file(path, "cannot be written: " + reason_of(errno));
  for (std::size_t written = 0; written < line->size;) {
    const ssize_t bytes = ::write(file.get(), &line->characters[written], line->size - written);
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes < 0) {
      const std::string why = reason_of(errno);
      ::unlink(path.c_str());
      refuse_key_file(path, "cannot be written: " + why);
    }
    written += static_cast<std::size_t>(bytes);
  }
}

}  // namespace

KeyPair read_key_pair(const std::string& path) {
  SecretKey secret;
  read_secret(path, kSecret, secret);
  return key_pair_from(*secret);
}

SecretKey read_shared_key(const std::string& path) {
  SecretKey key;
  read_secret(path, kShared, key);
  return key;
}

PublicKey read_public_key(const std::string& key_or_path) {
  if (const std::optional<PublicKey> key = public_key_from(key_or_path)) return *key;
  Locked<KeyFileText> text;
  read_key_file(key_or_path, false, *text);
  const std::optional<PublicKey> key = public_key_from(key_in(*text, kPublic, key_or_path));
  if (!key) refuse_key_text(key_or_path, kPublic);
  return *key;
}

void write_secret_key(const std::string& path, const SecretKey& key) { write_key_file(path, kSecret, *key); }

void write_shared_key(const std::string& path, const SecretKey& key) { write_key_file(path, kShared, *key); }

}  // namespace forcebound::security

#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace forcebound::driver {

/// A kind of plug-in: a shared library with one function that gives the table of its others.
struct PluginKind {
  const char* name;    ///< "driver", as errors say
  const char* prefix;  ///< of a file's name: "forcebound-device-"
  const char* folder;  ///< of those installed, in lib/forcebound: "devices"
  const char* entry;   ///< that one function
  const char* header;  ///< which declares it
};

/// The folders in which plug-ins are looked for, in this order.
/// @param path what an environment variable holds, colons between folders; may be null
/// @param program the running program's file: beside it, in ../lib/forcebound, are the installed ones
[[nodiscard]] std::vector<std::string> plugin_folders(const PluginKind& kind, const char* path,
                                                      const std::string& program);

/// The file of a plug-in, its prefix with NAME.so, in the first folder that has it.
[[nodiscard]] std::optional<std::string> find_plugin(const PluginKind& kind, std::string_view name,
                                                     const std::vector<std::string>& folders);

/// The names of all plug-ins there, sorted, each once.
[[nodiscard]] std::vector<std::string> plugins_in(const PluginKind& kind, const std::vector<std::string>& folders);

/// A plug-in's file, which stays open as long as this lives.
class SharedLibrary {
 public:
  /// @throws std::runtime_error in one line: what the file is not, for which processor it is, or who else may write it
  SharedLibrary(const PluginKind& kind, const std::string& file);
  ~SharedLibrary();
  SharedLibrary(const SharedLibrary&) = delete;
  SharedLibrary& operator=(const SharedLibrary&) = delete;

  /// The table that the plug-in's one function gives, whose first fields are its size and its interface's version.
  /// @param interface that this program has @throws std::runtime_error in one line where it lacks one or has another
  template <class Table>
  [[nodiscard]] const Table& table(unsigned interface) const {
    using Entry = const Table* (*)(unsigned);
    const auto* const table = static_cast<const Table*>(called(interface, [](void* entry, unsigned wanted) {
      return static_cast<const void*>(reinterpret_cast<Entry>(entry)(wanted));
    }));
    if (table->interface_version != interface) refuse_interface(table->interface_version, interface);
    return *table;
  }

  /// @throws std::runtime_error where it lacks one of its functions
  void expect_function(bool there, const char* function) const;

  /// @throws std::runtime_error always: "driver FILE: WHY"
  [[noreturn]] void refuse(const std::string& why) const;

  [[nodiscard]] const std::string& file() const noexcept { return file_; }

 private:
  [[nodiscard]] const void* called(unsigned interface, const void* (*call)(void* entry, unsigned interface)) const;
  [[noreturn]] void refuse_interface(unsigned has, unsigned interface) const;

  PluginKind kind_;
  std::string file_;
  void* library_;
};

}  // namespace forcebound::driver

#include "library/source/errors.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <new>
#include <span>
#include <stdexcept>

#include "forcebound/text/printable.hpp"

namespace forcebound::library {
namespace {

struct ErrorText {
  std::array<char, 1024> text{};
  std::size_t bytes = 0;

  void add(std::string_view words) noexcept {
    const std::size_t fits = std::min(words.size(), text.size() - 1 - bytes);
    std::copy_n(words.begin(), fits, text.begin() + static_cast<std::ptrdiff_t>(bytes));
    bytes += fits;
  }
};

ErrorText& of_this_thread() noexcept {
  thread_local ErrorText error;
  return error;
}

}  // namespace

void store_error(std::string_view function, std::string_view why) noexcept {
  ErrorText& error = of_this_thread();
  error.bytes = 0;
  error.add(function);
  error.add(": ");
  error.add(why);
  text::make_printable(std::span(error.text).first(error.bytes));
  error.text.at(error.bytes) = '\0';
}

fb_status store_exception(std::string_view function) noexcept {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return refused(function, "there is not enough memory", FB_NO_MEMORY);
  } catch (const std::invalid_argument& error) {
    return refused(function, error.what());
  } catch (const std::exception& error) {
    return refused(function, error.what(), FB_FAILED);
  } catch (...) {
    return refused(function, "an exception of an unknown kind", FB_FAILED);
  }
}

}  // namespace forcebound::library

const char* fb_last_error(void) { return forcebound::library::of_this_thread().text.data(); }

const char* fb_version(void) { return FORCEBOUND_VERSION; }

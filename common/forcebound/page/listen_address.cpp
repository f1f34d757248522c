#include "forcebound/page/listen_address.hpp"

#include <array>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "forcebound/page/request_check.hpp"
#include "forcebound/security/random.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::page {

ListenAddress parse_listen_address(std::string_view text, std::uint16_t standard) {
  ListenAddress at{.port = standard};
  if (text.empty()) return at;
  const std::size_t colon = text.rfind(':');
  const std::string_view digits = colon == std::string_view::npos ? text : text.substr(colon + 1);
  const auto port = text::whole_number<std::uint16_t>(digits);
  if (!port || colon == 0) {
    const std::string number = std::to_string(standard);
    throw std::invalid_argument("'" + text::printable(text) + "' is no PORT or HOST:PORT; accepted are " + number +
                                ", 127.0.0.1:" + number + ", [::1]:" + number + ", or port 0 for a free one");
  }
  at.port = *port;
  if (colon != std::string_view::npos) at.host = text.substr(0, colon);
  return at;
}

namespace {

constexpr const char* kVariable = "FORCEBOUND_PAGE_TOKEN";
constexpr const char* kIndex = "index.html";

/// The token in the environment, which other users do not see, unlike command lines; empty: there is none.
std::string token_given(std::size_t digits) {
  const char* const text = std::getenv(kVariable);
  if (text == nullptr) return {};
  const std::string token = text;
  if (token.size() != digits || token.find_first_not_of("0123456789abcdef") != std::string::npos) {
    // Not the token itself, which may be a secret with a typing error.
    throw std::runtime_error(std::string(kVariable) + " in the environment must have " + std::to_string(digits) +
                             " digits of 0 to 9 and a to f, got " + std::to_string(token.size()) + " characters");
  }
  return token;
}

}  // namespace

std::string printed_address(const std::string& address) {
  if (std::getenv(kVariable) == nullptr) return address;
  return address.substr(0, address.find('?')) + " with the token of " + kVariable;
}

std::string missing_page(const std::string& program_path) {
  const std::filesystem::path folder = page_folder(program_path);
  if (std::filesystem::exists(folder / kIndex)) return {};
  return "the live page is not in " + folder.string() +
         ": bundling it takes node, npm and npm's registry; run deploy/setup, then configure and build again";
}

PageServer::Settings page_settings(const ListenAddress& at, const std::string& program_path) {
  constexpr std::size_t kTokenBytes = 16;
  PageServer::Settings settings{.host = at.host,
                                .port = at.port,
                                .token = token_given(2 * kTokenBytes),
                                .assets = read_assets(page_folder(program_path))};
  if (const std::string why = missing_page(program_path); !why.empty()) {
    settings.assets.insert_or_assign(kIndex, Asset{std::string(content_type(".txt")), why + '\n'});
  }
  if (!settings.token.empty()) return settings;
  std::array<std::byte, kTokenBytes> random{};
  security::fill_with_random(random);
  settings.token = token_of(random);
  return settings;
}

}  // namespace forcebound::page

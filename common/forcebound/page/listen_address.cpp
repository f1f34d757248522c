#include "forcebound/page/listen_address.hpp"

#include <array>
#include <cstddef>
#include <stdexcept>

#include "forcebound/page/request_check.hpp"
#include "forcebound/security/random.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::page {

ListenAddress parse_listen_address(std::string_view text) {
  ListenAddress at;
  if (text.empty()) return at;
  const std::size_t colon = text.rfind(':');
  const std::string_view digits = colon == std::string_view::npos ? text : text.substr(colon + 1);
  const auto port = text::whole_number<std::uint16_t>(digits);
  if (!port || colon == 0) {
    throw std::invalid_argument("'" + text::printable(text) +
                                "' is no PORT or HOST:PORT; accepted are 47880, 127.0.0.1:47880, [::1]:47880, or port "
                                "0 for a free one");
  }
  at.port = *port;
  if (colon != std::string_view::npos) at.host = text.substr(0, colon);
  return at;
}

PageServer::Settings page_settings(const ListenAddress& at, const std::string& program_path) {
  constexpr std::size_t kTokenBytes = 16;
  std::array<std::byte, kTokenBytes> random{};
  security::fill_with_random(random);
  return {
      .host = at.host, .port = at.port, .token = token_of(random), .assets = read_assets(page_folder(program_path))};
}

}  // namespace forcebound::page

#include "forcebound/security/base64.hpp"

#include <sodium.h>

namespace forcebound::security {

std::string base64_of(std::span<const std::byte> bytes) {
  constexpr int kVariant = sodium_base64_VARIANT_ORIGINAL;
  std::string text(::sodium_base64_encoded_len(bytes.size(), kVariant), '\0');
  ::sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                      kVariant);
  text.pop_back();  // the zero at its end
  return text;
}

}  // namespace forcebound::security

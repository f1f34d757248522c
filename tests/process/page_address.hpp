#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "tests/process/programs.hpp"

namespace forcebound::test {

/// Where a program says that its page is.
struct PageAddress {
  std::string host;
  std::uint16_t port = 0;
  std::string query;  ///< "?token=..."

  explicit PageAddress(Process& program) {
    EXPECT_TRUE(program.wait_for("/?token="));
    EXPECT_TRUE(program.wait_for("\n"));
    const std::string out = program.out();
    const std::size_t begin = out.find("http://") + std::string("http://").size();
    const std::string address = out.substr(begin, out.find('\n', begin) - begin);
    const std::size_t colon = address.find(':');
    const std::size_t slash = address.find('/');
    host = address.substr(0, colon);
    port = static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1, slash - colon - 1)));
    query = address.substr(address.find('?'));
  }

  [[nodiscard]] std::string authority() const { return host + ":" + std::to_string(port); }
  [[nodiscard]] std::string whole() const { return "http://" + authority() + "/" + query; }
};

/// What a forcebound-relay says where its --control is.
inline std::string control_of(Process& relay) {
  EXPECT_TRUE(relay.wait_for("taken at "));
  const std::string log = relay.out() + relay.err();
  const std::size_t begin = log.find("taken at ") + std::string("taken at ").size();
  return log.substr(begin, log.find('\n', begin) - begin);
}

}  // namespace forcebound::test

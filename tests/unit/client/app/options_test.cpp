#include "forcebound/client/app/options.hpp"

#include <gtest/gtest.h>

#include <array>

namespace forcebound::client {
namespace {

TEST(ClientOptions, RenderLocallyUnlessRemoteIsSaid) {
  const std::array unsaid{"forcebound-client", "--server", "127.0.0.1:47800"};
  EXPECT_EQ(parse_options(static_cast<int>(unsaid.size()), unsaid.data()).rendering, "local");
  const std::array said{"forcebound-client", "--server", "127.0.0.1:47800", "--rendering", "remote"};
  EXPECT_EQ(parse_options(static_cast<int>(said.size()), said.data()).rendering, "remote");
}

}  // namespace
}  // namespace forcebound::client

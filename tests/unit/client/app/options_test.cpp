#include "forcebound/client/app/options.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "forcebound/program/command_line.hpp"

namespace forcebound::client {
namespace {

TEST(ClientOptions, RenderLocallyUnlessRemoteIsSaid) {
  const std::array unsaid{"forcebound-client", "--server", "127.0.0.1:47800"};
  EXPECT_EQ(parse_options(static_cast<int>(unsaid.size()), unsaid.data()).rendering, "local");
  const std::array said{"forcebound-client", "--server", "127.0.0.1:47800", "--rendering", "remote"};
  EXPECT_EQ(parse_options(static_cast<int>(said.size()), said.data()).rendering, "remote");
}

Options with_rate(const char* rate_Hz) {
  const std::array words{"forcebound-client", "--server", "127.0.0.1:47800", "--rate", rate_Hz};
  return parse_options(static_cast<int>(words.size()), words.data());
}

TEST(ClientOptions, LeaveTheRateToTheDeviceUnlessOneIsSaid) {
  const std::array unsaid{"forcebound-client", "--server", "127.0.0.1:47800"};
  EXPECT_EQ(parse_options(static_cast<int>(unsaid.size()), unsaid.data()).device.rate_Hz, 0);
  EXPECT_EQ(with_rate("500").device.rate_Hz, 500);
  EXPECT_EQ(with_rate("4000").device.rate_Hz, 4000);
}

TEST(ClientOptions, RefuseARateThatNoLoopRunsAt) {
  for (const char* const rate_Hz : {"499.9", "4000.1", "0", "-1000", "nan", "fast"}) {
    SCOPED_TRACE(rate_Hz);
    EXPECT_THROW((void)with_rate(rate_Hz), program::End);
  }
}

}  // namespace
}  // namespace forcebound::client
